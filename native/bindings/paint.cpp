// SPDX-License-Identifier: GPL-3.0-or-later
#include "isograft/paint.h"

#include <tuple>
#include <utility>
#include <vector>

#include "image_arrays.h"

using namespace isograft;
using namespace isograft::bindings;

void bind_paint(py::module_& m) {
    m.def(
        "paint",
        [](const DoubleArray& uv, const py::array_t<bool, py::array::c_style>& wanted,
           const std::vector<std::tuple<DoubleArray, py::array>>& channels, int width, int height, int margin,
           ByteArray mask, int threads, const py::object& progress) {
            const CornerUV corner_uv = to_corner_uv(uv, "the layout");
            const Mask chosen = Eigen::Map<const Mask>(wanted.data(), wanted.size());
            const BakeOptions options{width, height, margin, threads};
            options.validate();
            check_mask(mask, width, height);
            std::vector<PaintChannel> given;
            for (const auto& [values, result] : channels) {
                PaintChannel channel;
                channel.values = to_values(values, "the values to paint");
                check_pixels(result, static_cast<int>(channel.values.cols()));
                set_result(result, width, height, channel);
                given.push_back(std::move(channel));
            }
            std::uint8_t* texels = mask.mutable_data();
            run_with_progress(progress,
                              [&](Monitor& monitor) { paint(corner_uv, chosen, given, options, texels, &monitor); });
        },
        py::arg("uv"), py::arg("wanted"), py::arg("channels"), py::arg("width"), py::arg("height"), py::arg("margin"),
        py::arg("mask"), py::arg("threads"), py::arg("progress"));
}

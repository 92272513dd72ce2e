// SPDX-License-Identifier: GPL-3.0-or-later
#include "isograft/bake.h"

#include <cstdint>
#include <optional>
#include <tuple>
#include <vector>

#include "image_arrays.h"

namespace {

using namespace isograft;
using namespace isograft::bindings;

// Images by material, components, UVs, extension, closest, is_normal, result.
using ChannelTuple = std::tuple<std::vector<std::optional<py::array>>, int, DoubleArray, int, bool, bool, py::array>;

Pixels to_pixels(const std::optional<py::array>& image, int components) {
    Pixels pixels;
    if (!image) return pixels;
    check_pixels(*image, components);
    if (is_byte(*image)) {
        pixels.bytes = static_cast<const std::uint8_t*>(image->data());
    } else {
        pixels.reals = static_cast<const float*>(image->data());
    }
    pixels.height = static_cast<int>(image->shape(0));
    pixels.width = static_cast<int>(image->shape(1));
    return pixels;
}

BakeChannel to_channel(const ChannelTuple& given, int width, int height) {
    const auto& [images, components, uv, extension, closest, is_normal, result] = given;
    BakeChannel channel;
    channel.components = components;
    for (const auto& image : images) channel.images.push_back(to_pixels(image, components));
    channel.uv = to_corner_uv(uv, "the donor's UVs");
    channel.extension = static_cast<Extension>(extension);
    channel.closest = closest;
    channel.is_normal = is_normal;
    check_pixels(result, components);
    set_result(result, width, height, channel);
    return channel;
}

}  // namespace

void bind_bake(py::module_& m) {
    m.def(
        "bake",
        [](const IntArray& face, const DoubleArray& barycentric, const IntArray& vertex,
           const DoubleArray& receiver_vertices, const IntArray& receiver_faces, const DoubleArray& receiver_uv,
           const py::array_t<bool, py::array::c_style>& wanted, const DoubleArray& donor_vertices,
           const IntArray& donor_faces, const IntArray& donor_materials, const std::vector<ChannelTuple>& channels,
           int width, int height, int margin, ByteArray mask, int threads, const py::object& progress) {
            const Correspondence correspondence = to_correspondence(face, barycentric, vertex);
            const Points own = to_points(receiver_vertices, "receiver_vertices");
            const Points other = to_points(donor_vertices, "donor_vertices");
            const Triangles own_faces = to_triangles(receiver_faces, "receiver_faces");
            const Triangles other_faces = to_triangles(donor_faces, "donor_faces");
            const CornerUV corner_uv = to_corner_uv(receiver_uv, "receiver_uv");
            const Mask chosen = Eigen::Map<const Mask>(wanted.data(), wanted.size());
            const Eigen::VectorXi materials = to_int_vector(donor_materials);
            const Eigen::VectorXi no_polygons;
            const BakeOptions options{width, height, margin, threads};
            options.validate();
            check_mask(mask, width, height);
            std::vector<BakeChannel> given;
            for (const ChannelTuple& channel : channels) given.push_back(to_channel(channel, width, height));
            std::uint8_t* texels = mask.mutable_data();
            Mask baked;
            run_with_progress(progress, [&](Monitor& monitor) {
                baked = bake(correspondence, {own, own_faces, no_polygons}, corner_uv, chosen, {other, other_faces},
                             materials, given, options, texels, &monitor);
            });
            return py::array_t<bool>(baked.size(), baked.data());
        },
        py::arg("face"), py::arg("barycentric"), py::arg("vertex"), py::arg("receiver_vertices"),
        py::arg("receiver_faces"), py::arg("receiver_uv"), py::arg("wanted"), py::arg("donor_vertices"),
        py::arg("donor_faces"), py::arg("donor_materials"), py::arg("channels"), py::arg("width"), py::arg("height"),
        py::arg("margin"), py::arg("mask"), py::arg("threads"), py::arg("progress"));
}

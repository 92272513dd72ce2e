// SPDX-License-Identifier: GPL-3.0-or-later
#include "isograft/match.h"

#include <array>
#include <cstdint>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "bindings.h"
#include "isograft/gate.h"
#include "isograft/memory.h"

namespace isograft::bindings {

namespace {

std::string flat_name(const char* stage, const char* field) { return std::string(stage) + "_" + field; }

py::dict to_dict(MatchOptions& options) {
    py::dict fields;
    options.visit(
        [&](const char* stage, const char* name, auto& field) { fields[py::str(flat_name(stage, name))] = field; });
    return fields;
}

/// Set the fields that `overrides` names. \throw InvalidInput for a name that no stage has, or a wrong type.
void apply(const py::dict& overrides, MatchOptions& options) {
    std::set<std::string> unknown;
    for (const auto& item : overrides) unknown.insert(py::cast<std::string>(item.first));
    options.visit([&](const char* stage, const char* name, auto& field) {
        const std::string key = flat_name(stage, name);
        if (unknown.erase(key) == 0) return;
        using Field = std::remove_reference_t<decltype(field)>;
        try {
            field = py::cast<Field>(overrides[py::str(key)]);
        } catch (const py::cast_error&) {
            throw InvalidInput(key + " has a value of the wrong type or out of range");
        }
    });
    if (!unknown.empty()) throw InvalidInput("there is no option " + *unknown.begin());
}

void set_scale(const std::string& mode, double value, ScaleOptions& options) {
    if (mode == "auto") {
        options.mode = ScaleMode::automatic;
    } else if (mode == "fixed") {
        options.mode = ScaleMode::fixed;
    } else {
        options.mode = ScaleMode::given;
        options.value = value;
    }
}

std::vector<Landmark> to_landmarks(const IntArray& pairs, const DoubleArray& weights) {
    if (pairs.ndim() != 2 || pairs.shape(1) != 2) throw InvalidInput("landmarks must have shape (k, 2)");
    if (weights.ndim() != 1 || weights.shape(0) != pairs.shape(0)) throw InvalidInput("landmarks need a weight each");
    std::vector<Landmark> landmarks;
    const auto rows = pairs.unchecked<2>();
    const auto weight = weights.unchecked<1>();
    for (py::ssize_t i = 0; i < rows.shape(0); ++i) landmarks.push_back({rows(i, 0), rows(i, 1), weight(i)});
    return landmarks;
}

Match match_arrays(const Surface& source, const Surface& target, const std::string& preset, const py::dict& overrides,
                   const IntArray& landmarks, const DoubleArray& landmark_weights, const std::string& scale_mode,
                   double scale_value, int threads, std::uint64_t seed, std::int64_t memory_limit,
                   const py::object& progress) {
    MatchOptions options = preset_options(preset);
    apply(overrides, options);
    set_scale(scale_mode, scale_value, options.scale);
    options.landmarks = to_landmarks(landmarks, landmark_weights);
    options.threads = threads;
    options.random_seed = seed;
    options.memory_limit = memory_limit;
    Match result;
    run_with_progress(progress, [&](Monitor& monitor) { result = match(source, target, options, &monitor); });
    return result;
}

}  // namespace

void bind_match(py::module_& m) {
    py::class_<StageReport>(m, "StageReport")
        .def_readonly("name", &StageReport::name)
        .def_readonly("seconds", &StageReport::seconds)
        .def_readonly("bytes", &StageReport::bytes);

    py::class_<MatchReport>(m, "MatchReport")
        .def_readonly("stages", &MatchReport::stages)
        .def_readonly("seconds", &MatchReport::seconds)
        .def_readonly("scale", &MatchReport::scale)
        .def_readonly("unit_length", &MatchReport::unit_length)
        .def_readonly("source_samples", &MatchReport::source_samples)
        .def_readonly("target_samples", &MatchReport::target_samples)
        .def_readonly("seeds_tried", &MatchReport::seeds_tried)
        .def_readonly("maps_grown", &MatchReport::maps_grown)
        .def_readonly("maps_in_core", &MatchReport::maps_in_core)
        .def_readonly("warnings", &MatchReport::warnings);

    py::class_<Match>(m, "Match")
        .def_readonly("correspondences", &Match::correspondences)
        .def_readonly("report", &Match::report);

    m.def(
        "preset_options",
        [](const std::string& name) {
            MatchOptions options = preset_options(name);
            return to_dict(options);
        },
        py::arg("name"));

    m.def("match", &match_arrays, py::arg("source"), py::arg("target"), py::arg("preset"), py::arg("overrides"),
          py::arg("landmarks"), py::arg("landmark_weights"), py::arg("scale_mode"), py::arg("scale_value"),
          py::arg("threads"), py::arg("seed"), py::arg("memory_limit"), py::arg("progress"));

    m.def(
        "gate_share",
        [](const std::vector<std::array<std::int64_t, 2>>& made, std::array<std::int64_t, 2> source,
           std::array<std::int64_t, 2> target, const std::string& preset, const py::dict& overrides, int threads) {
            MatchOptions options = preset_options(preset);
            apply(overrides, options);
            options.threads = threads;
            std::vector<MeshSize> sizes;
            for (const auto& [vertices, triangles] : made) sizes.push_back({vertices, triangles});
            return gate_share(sizes, {source[0], source[1]}, {target[0], target[1]}, options);
        },
        py::arg("made"), py::arg("source"), py::arg("target"), py::arg("preset"), py::arg("overrides"),
        py::arg("threads"));

    m.def(
        "check_memory",
        [](std::array<std::int64_t, 2> source, std::array<std::int64_t, 2> target, const std::string& preset,
           const py::dict& overrides, int threads, std::int64_t limit) {
            MatchOptions options = preset_options(preset);
            apply(overrides, options);
            options.threads = threads;
            check_memory({source[0], source[1]}, {target[0], target[1]}, options, limit);
            return estimated_memory({source[0], source[1]}, {target[0], target[1]}, options);
        },
        py::arg("source"), py::arg("target"), py::arg("preset"), py::arg("overrides"), py::arg("threads"),
        py::arg("limit"));
}

}  // namespace isograft::bindings

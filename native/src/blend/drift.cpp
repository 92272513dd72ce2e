// SPDX-License-Identifier: GPL-3.0-or-later
#include "blend/drift.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace isograft {

namespace {

// The grid of moves: so many cells of one spacing either side of the middle.
constexpr int half_grid = 5;
constexpr int grid = 2 * half_grid + 1;
// How far neighbours are asked, in spacings.
constexpr double surroundings = 4.5;

// The move of a cell of the grid, in spacings.
Complex move_of(int cell) {
    const int row = cell / grid;
    return {static_cast<double>(cell - row * grid - half_grid), static_cast<double>(row - half_grid)};
}

// Takes a direction at one end of an edge along it, to the other end.
Complex along(const SampleEdge& edge, int from) {
    return from == edge.u ? -edge.at_v * std::conj(edge.at_u) : -edge.at_u * std::conj(edge.at_v);
}

}  // namespace

DriftFinder::DriftFinder(const Pair& pair, const FeatureOptions& options)
    : pair_(pair), options_(options), spacing_(pair.source.samples.spacing), known_(pair.source.samples.count()) {
    const int count = pair.target.samples.count();
    around_.reserve(count);
    for (int t = 0; t < count; ++t) around_.push_back(unfold(t));
}

std::vector<DriftFinder::Near> DriftFinder::unfold(int middle) const {
    const Samples& target = pair_.target.samples;
    const double reach = (half_grid + 1) * spacing_;
    std::vector<Near> result{{middle, {0.0, 0.0}, {1.0, 0.0}}};
    std::vector<int> found{middle};
    for (std::size_t i = 0; i < result.size(); ++i) {
        const Near from = result[i];
        for (const int e : target.base_edges_of[from.sample]) {
            const SampleEdge& edge = target.edges[e];
            const int other = edge.other(from.sample);
            const Complex direction = from.sample == edge.u ? edge.at_u : edge.at_v;
            const Complex offset = from.offset + std::conj(from.turn) * direction * edge.length;
            if (modulus(offset) > reach || std::find(found.begin(), found.end(), other) != found.end()) continue;
            // Way round a limb, directions have turned so much that what comes back is anywhere.
            const double apart = (target.position[other] - target.position[middle]).norm();
            if (apart > modulus(offset) + 0.5 * spacing_) continue;
            found.push_back(other);
            result.push_back({other, offset, from.turn * along(edge, from.sample)});
        }
    }
    return result;
}

// What the moves of the grid do to one sample's mismatch, in the frame of the source.
std::vector<DriftFinder::Cell> DriftFinder::moves(const PartialMap& map, int sample) const {
    const TriangleMesh& mesh = pair_.target.mesh;
    const Samples& target = pair_.target.samples;
    std::vector<Cell> result;
    const int middle = target.nearest(mesh, map.image[sample]);
    if (middle < 0) return result;
    result.resize(grid * grid);
    const int face = target.point[middle].face;
    const Complex rotation = carry(mesh, map.image[sample].face, face, map.rotation[sample]);
    const Complex start = flatten(mesh, face, map.position[sample] - target.position[middle]);
    // Every place of the grid is that of the target's nearest sample.
    std::vector<float> nearest(result.size(), 1.0F);
    std::vector<int> which(result.size(), -1);
    for (std::size_t i = 0; i < around_[middle].size(); ++i) {
        const Complex at = (around_[middle][i].offset - start) * std::conj(rotation) / spacing_;
        const int x0 = static_cast<int>(std::lround(at.real())) + half_grid;
        const int y0 = static_cast<int>(std::lround(at.imag())) + half_grid;
        for (int y = std::max(0, y0 - 1); y <= std::min(grid - 1, y0 + 1); ++y) {
            for (int x = std::max(0, x0 - 1); x <= std::min(grid - 1, x0 + 1); ++x) {
                const auto d = static_cast<float>(std::norm(at - Complex(x - half_grid, y - half_grid)));
                if (d >= nearest[y * grid + x]) continue;
                nearest[y * grid + x] = d;
                which[y * grid + x] = static_cast<int>(i);
            }
        }
    }
    const std::lock_guard lock(locks_[static_cast<std::size_t>(sample) % locks_.size()]);
    for (std::size_t c = 0; c < result.size(); ++c) {
        if (which[c] < 0) continue;
        const Near& near = around_[middle][which[c]];
        const int shift = shift_of(near.turn * rotation) + descriptor_angles - turns / 2;
        result[c].count = 1.0F;
        auto [known, is_new] = known_[sample].try_emplace(near.sample);
        if (is_new) known->second.fill(-1.0F);
        for (int k = 0; k < turns; ++k) {
            const int turned = (shift + k) % descriptor_angles;
            float& d = known->second[turned];
            if (d < 0.0F) {
                d = static_cast<float>(
                    std::min(3.0, descriptor_distance(pair_.source_descriptor[sample],
                                                      pair_.target_descriptor[near.sample], turned, options_) /
                                      pair_.chance));
            }
            result[c].sum[k] = d;
        }
    }
    return result;
}

std::vector<Drift> DriftFinder::find(const PartialMap& map, int threads, Monitor& monitor) const {
    const Samples& source = pair_.source.samples;
    std::vector<std::vector<Cell>> own(source.count());
    parallel_for(
        source.count(), threads,
        [&](int s, int /*worker*/) {
            if (map.mapped[s]) own[s] = moves(map, s);
        },
        monitor);
    std::vector<Drift> result(source.count());
    const auto judge = [&](int s, int /*worker*/) {
        if (!map.mapped[s]) return;
        std::array<Cell, grid * grid> cells{};
        int voices = 0;
        const auto add = [&](int sample, Complex there) {
            if (own[sample].empty()) return;
            ++voices;
            for (int c = 0; c < grid * grid; ++c) {
                const Complex at = move_of(c) * there;
                const int x = static_cast<int>(std::lround(at.real())) + half_grid;
                const int y = static_cast<int>(std::lround(at.imag())) + half_grid;
                if (x < 0 || y < 0 || x >= grid || y >= grid) continue;
                const Cell& from = own[sample][y * grid + x];
                cells[c].count += from.count;
                for (int k = 0; k < turns; ++k) cells[c].sum[k] += from.sum[k];
            }
        };
        add(s, {1.0, 0.0});
        for (const int e : source.edges_of[s]) {
            const SampleEdge& edge = source.edges[e];
            if (edge.length < surroundings * spacing_ && map.mapped[edge.other(s)]) add(edge.other(s), along(edge, s));
        }
        const Cell& middle = cells[half_grid * grid + half_grid];
        if (middle.count == 0.0F) return;
        Drift& drift = result[s];
        drift.here = drift.there = middle.sum[turns / 2] / middle.count;
        for (int c = 0; c < grid * grid; ++c) {
            if (cells[c].count < 0.6F * static_cast<float>(voices)) continue;
            const double best = *std::min_element(cells[c].sum.begin(), cells[c].sum.end()) / cells[c].count;
            if (best >= drift.there) continue;
            drift.there = best;
            drift.offset = move_of(c) * spacing_ * map.rotation[s];
        }
    };
    parallel_for(source.count(), threads, judge, monitor);
    return result;
}

}  // namespace isograft

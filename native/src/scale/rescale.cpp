// SPDX-License-Identifier: GPL-3.0-or-later
#include "scale/rescale.h"

namespace isograft {

namespace {

void scale_samples(Samples& samples, double factor) {
    samples.spacing *= factor;
    for (auto& p : samples.position) p *= factor;
    for (double& a : samples.area) a *= factor * factor;
    for (SampleEdge& e : samples.edges) e.length *= factor;
    for (auto& list : samples.near_vertex) {
        for (NearSample& near : list) near.distance *= static_cast<float>(factor);
    }
}

}  // namespace

void rescale(PreparedPair& prepared, double factor, const MatchOptions& options, Monitor& monitor, double from,
             double to) {
    Pair& pair = prepared.pair;
    prepared.setting.scale *= factor;
    prepared.source.factor *= factor;
    prepared.source.coarse.mesh = scaled(prepared.source.coarse.mesh, factor);
    pair.source.mesh = prepared.source.coarse.mesh;
    scale_samples(pair.source.samples, factor);
    for (double& h : pair.source_curvature) h /= factor;
    for (double& h : pair.source_detail) h /= factor;
    pair.source_descriptor = window_descriptors(pair.source.mesh, pair.source.samples.point, pair.source_curvature, 1.0,
                                                options.feature, options.threads, monitor, from, to);
}

}  // namespace isograft

// SPDX-License-Identifier: GPL-3.0-or-later
#include "growth/image_cells.h"

#include <gtest/gtest.h>

#include "twins.h"

namespace isograft {
namespace {

const Twins& twins() { return Twins::of_a_blob(); }

TEST(ImageCells, APlaceIsTakenByASampleFromElsewhere) {
    const Samples& source = twins().pair().source.samples;
    const double radius = 0.5 * source.spacing;
    const PartialMap truth = twins().true_map(twins().all_samples());
    ImageCells images(twins().pair());
    EXPECT_FALSE(images.taken(truth, 0, truth.image[7], radius));
    images.put(truth, 7);
    int near = 0, far = 0;
    for (const int s : twins().all_samples()) {
        const double apart = (source.position[s] - source.position[7]).norm();
        // A neighbour may come near.
        const bool elsewhere = apart > 2.0 * source.spacing;
        EXPECT_EQ(images.taken(truth, s, truth.image[7], radius), elsewhere);
        ++(elsewhere ? far : near);
        if (elsewhere) {
            EXPECT_FALSE(images.taken(truth, s, truth.image[s], radius));
        }
    }
    EXPECT_GT(near, 3);
    EXPECT_GT(far, 50);
}

TEST(ImageCells, LooksAcrossTheBordersOfCellsAndNotBeyondTheRadius) {
    const SampledMesh& target = twins().pair().target;
    const PartialMap truth = twins().true_map(twins().all_samples());
    const int far = static_cast<int>(twins().all_samples().size()) - 1;
    int across = 0;
    for (const SampleEdge& edge : target.samples.edges) {
        if (edge.level > 0 || edge.length > target.samples.spacing * 1.3) continue;
        // A sample from elsewhere on one end of an edge of T's, asked for at the other.
        const int s = (truth.position[0] - target.samples.position[edge.u]).norm() > 0.3 ? 0 : far;
        PartialMap map = truth;
        map.put(target.mesh, s, target.samples.point[edge.u], Complex(1.0, 0.0));
        ImageCells images(twins().pair());
        images.put(map, s);
        int other = 0;
        const Samples& source = twins().pair().source.samples;
        while ((source.position[other] - source.position[s]).norm() <= 2.0 * source.spacing) ++other;
        const double apart = (target.samples.position[edge.u] - target.samples.position[edge.v]).norm();
        EXPECT_TRUE(images.taken(map, other, target.samples.point[edge.v], 1.01 * apart));
        EXPECT_FALSE(images.taken(map, other, target.samples.point[edge.v], 0.99 * apart));
        ++across;
    }
    EXPECT_GT(across, 50);
}

}  // namespace
}  // namespace isograft

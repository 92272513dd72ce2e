// SPDX-License-Identifier: GPL-3.0-or-later
#include "blend/anchors.h"

#include <vector>

#include <gtest/gtest.h>

#include "shapes.h"
#include "twins.h"

namespace isograft {
namespace {

TEST(Anchors, FitWhatIsRightAndNotWhatIsFarFromIt) {
    const Twins& twins = Twins::of_a_blob();
    const Pair& pair = twins.pair();
    DistanceFields fields(pair);
    Anchors anchors(fields);
    Monitor monitor;
    ASSERT_TRUE(anchors.place(twins.true_map(twins.all_samples()), 12, monitor));
    double wrong = 0.0;
    int count = 0;
    for (int s = 0; s < pair.source.samples.count(); s += 5) {
        EXPECT_LT(anchors.incompatibility(s, twins.true_match(s).point), 0.05);
        // The image of another sample, far away.
        const int other = (s + pair.source.samples.count() / 2) % pair.source.samples.count();
        const auto gap = pair.source.samples.position[s] - pair.source.samples.position[other];
        if (gap.norm() < 0.3) continue;
        wrong += anchors.incompatibility(s, twins.true_match(other).point);
        ++count;
    }
    ASSERT_GT(count, 5);
    EXPECT_GT(wrong / count, 0.2);
}

TEST(Anchors, SayAsMuchAboutPlacesOutsideTheMap) {
    const Twins& twins = Twins::of_a_blob();
    const Samples& samples = twins.pair().source.samples;
    std::vector<int> low;
    for (const int s : twins.all_samples()) {
        if (samples.position[s].y() < 0.0) low.push_back(s);
    }
    DistanceFields fields(twins.pair());
    Anchors anchors(fields);
    Monitor monitor;
    ASSERT_TRUE(anchors.place(twins.true_map(low), 12, monitor));
    for (int s = 0; s < samples.count(); s += 3) {
        if (samples.position[s].y() > 0.1) {
            EXPECT_LT(anchors.incompatibility(s, twins.true_match(s).point), 0.08);
        }
    }
}

TEST(Anchors, HaveNoPlaceOnAnEmptyMap) {
    const Twins& twins = Twins::of_a_blob();
    DistanceFields fields(twins.pair());
    Anchors anchors(fields);
    Monitor monitor;
    EXPECT_FALSE(anchors.place(twins.true_map({}), 12, monitor));
}

TEST(Anchors, MeasureFromTheImagesAndNotFromTheVerticesBeside) {
    // On a plane true matches differ by nothing, however near an anchor they are.
    const Twins twins(shapes::grid(25, 25, 0.1, 0.1, 0.03));
    DistanceFields fields(twins.pair());
    Anchors anchors(fields);
    Monitor monitor;
    ASSERT_TRUE(anchors.place(twins.true_map(twins.all_samples()), 12, monitor));
    for (const int s : twins.all_samples()) EXPECT_LT(anchors.incompatibility(s, twins.true_match(s).point), 1e-3);
}

}  // namespace
}  // namespace isograft

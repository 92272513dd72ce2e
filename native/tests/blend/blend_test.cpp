// SPDX-License-Identifier: GPL-3.0-or-later
#include "blend/blend.h"

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "isograft/errors.h"
#include "twins.h"

namespace isograft {
namespace {

const Twins& twins() { return Twins::of_a_blob(); }

PatchSettings few(int threads) {
    PatchSettings settings = twins().settings();
    settings.threads = threads;
    settings.blend.patches = 16;
    settings.blend.patch_size = 60;
    settings.blend.rounds = 1;
    settings.blend.careful_rounds = 1;
    settings.seed.probes = 24;
    return settings;
}

/// Patches of right matches, then of as many wrong ones: each where the sample half the list away belongs.
struct Grown {
    std::vector<Patch> patches;
    Core right, wrong;
};

Grown grow() {
    const int count = twins().pair().source.samples.count();
    std::vector<OrientedMatch> good, bad;
    for (int s = 0; s < count; s += 12) {
        good.push_back(twins().true_match(s));
        bad.push_back(twins().true_match((s + count / 2) % count));
        bad.back().sample = s;
    }
    Monitor monitor;
    Grown grown;
    grown.patches = grow_patches(twins().pair(), few(2), good, 0, monitor, 0.0, 1.0);
    const auto others = grow_patches(twins().pair(), few(2), bad, 0, monitor, 0.0, 1.0);
    const auto rights = static_cast<std::ptrdiff_t>(grown.patches.size());
    grown.patches.insert(grown.patches.end(), others.begin(), others.end());
    grown.right.member.assign(grown.patches.size(), 0);
    std::fill_n(grown.right.member.begin(), rights, char{1});
    for (const char m : grown.right.member) grown.wrong.member.push_back(m ? 0 : 1);
    grown.right.count = static_cast<int>(rights);
    grown.wrong.count = static_cast<int>(others.size());
    return grown;
}

const Grown& grown() {
    static const Grown once = grow();
    return once;
}

std::vector<Blended> blended(const std::vector<Core>& cores, int threads = 2) {
    Monitor monitor;
    return blend(twins().pair(), few(threads), grown().patches, cores, monitor, 0.0, 0.6, 1.0);
}

TEST(Blend, OfRightPatchesIsTheRightMapEverywhere) {
    const auto answers = blended({grown().right});
    ASSERT_EQ(answers.size(), 1U);
    const Blended& best = answers.front();
    const int count = twins().pair().source.samples.count();
    EXPECT_GT(best.map.count, 95 * count / 100);
    for (const int s : twins().all_samples()) {
        if (best.map.mapped[s]) {
            EXPECT_LT(twins().error(s, best.map.position[s]), 1.0);
            EXPECT_GE(best.risk[s], 0.0);
            EXPECT_LE(best.risk[s], twins().settings().blend.accept);
        } else {
            EXPECT_EQ(best.risk[s], 0.0);
        }
    }
    EXPECT_EQ(best.maps_in_core, grown().right.count);
    EXPECT_GT(best.fit, 0.0);
}

TEST(Blend, ChoosesTheRightCoreWhereverItStands) {
    for (const bool first : {true, false}) {
        const auto answers = first ? blended({grown().right, grown().wrong}) : blended({grown().wrong, grown().right});
        const PartialMap& map = answers.front().map;
        ASSERT_GT(map.count, 0);
        double sum = 0.0;
        for (const int s : twins().all_samples()) {
            if (map.mapped[s]) sum += twins().error(s, map.position[s]);
        }
        EXPECT_LT(sum / map.count, 0.3);
        EXPECT_EQ(answers.front().maps_in_core, grown().right.count);
        for (std::size_t i = 1; i < answers.size(); ++i) EXPECT_LE(answers[i].fit, answers[i - 1].fit);
    }
}

TEST(Blend, OfNoCoreIsAnEmptyMap) {
    const auto answers = blended({});
    ASSERT_EQ(answers.size(), 1U);
    EXPECT_EQ(answers.front().map.count, 0);
    EXPECT_EQ(answers.front().risk, std::vector<double>(twins().all_samples().size(), 0.0));
}

TEST(Blend, IsEqualBitForBitForAnyNumberOfThreads) {
    const auto one = blended({grown().right, grown().wrong}, 1);
    const auto two = blended({grown().right, grown().wrong}, 2);
    ASSERT_EQ(one.size(), two.size());
    for (std::size_t i = 0; i < one.size(); ++i) {
        EXPECT_EQ(one[i].map.mapped, two[i].map.mapped);
        EXPECT_EQ(one[i].map.rotation, two[i].map.rotation);
        EXPECT_EQ(one[i].risk, two[i].risk);
        EXPECT_EQ(one[i].fit, two[i].fit);
    }
}

TEST(Blend, ReportsFromWhereToWhereItWasTold) {
    std::vector<double> told;
    Monitor monitor([&](const std::string& stage, double fraction) {
        EXPECT_EQ(stage, "blend");
        told.push_back(fraction);
        return true;
    });
    blend(twins().pair(), few(1), grown().patches, {grown().right}, monitor, 0.2, 0.5, 0.7);
    EXPECT_NEAR(monitor.fraction(), 0.7, 1e-9);
    EXPECT_NEAR(told.front(), 0.2, 1e-9);
    EXPECT_TRUE(std::is_sorted(told.begin(), told.end()));
}

TEST(Blend, StopsWhenCancelled) {
    Monitor monitor;
    monitor.cancel();
    EXPECT_THROW(blend(twins().pair(), few(2), grown().patches, {grown().right}, monitor, 0.0, 0.6, 1.0), Cancelled);
}

}  // namespace
}  // namespace isograft

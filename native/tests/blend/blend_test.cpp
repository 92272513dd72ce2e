// SPDX-License-Identifier: GPL-3.0-or-later
#include "blend/blend.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
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

void expect_equal_bits(const std::vector<Blended>& one, const std::vector<Blended>& other) {
    ASSERT_EQ(one.size(), other.size());
    for (std::size_t i = 0; i < one.size(); ++i) {
        EXPECT_EQ(one[i].map.mapped, other[i].map.mapped);
        EXPECT_EQ(one[i].map.rotation, other[i].map.rotation);
        EXPECT_EQ(one[i].risk, other[i].risk);
        EXPECT_EQ(one[i].fit, other[i].fit);
    }
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

/// A body that half a turn about z nearly maps onto itself, and the patches of both maps.
struct TwoWays {
    Twins twins{shape()};
    std::vector<Patch> patches;
    std::vector<Core> cores{2};

    TwoWays() {
        const Samples& samples = twins.pair().source.samples;
        std::vector<OrientedMatch> straight, turned;
        for (int s = 0; s < samples.count(); s += 8) {
            const Eigen::Vector3d x = samples.position[s];
            int across = 0;
            for (int other = 0; other < samples.count(); ++other) {
                const auto away = [&](int k) { return (samples.position[k] - half_turn() * x).norm(); };
                if (away(other) < away(across)) across = other;
            }
            straight.push_back(twins.true_match(s));
            turned.push_back(twins.true_match(across));
            turned.back().sample = s;
            const TriangleMesh& target = twins.pair().target.mesh;
            const Eigen::Vector3d axis =
                twins.turn() * half_turn() * twins.pair().source.mesh.axis_x[samples.point[s].face];
            turned.back().rotation = unit(flatten(target, turned.back().point.face, axis));
        }
        Monitor monitor;
        for (const auto* matches : {&straight, &turned}) {
            const auto grown = grow_patches(twins.pair(), settings(0.0, 2), *matches, 0, monitor, 0.0, 1.0);
            patches.insert(patches.end(), grown.begin(), grown.end());
            Core& core = cores[matches == &straight ? 0 : 1];
            core.count = static_cast<int>(grown.size());
            core.member.assign(patches.size(), 1);
            if (matches == &turned) std::fill_n(core.member.begin(), patches.size() - grown.size(), char{0});
        }
        cores[0].member.resize(patches.size(), 0);
    }

    static PatchSettings settings(double alternative, int threads) {
        PatchSettings settings = few(threads);
        settings.blend.alternative = alternative;
        return settings;
    }

    [[nodiscard]] std::vector<Blended> blended(double alternative, const std::vector<Core>& some,
                                               int threads = 2) const {
        Monitor monitor;
        return blend(twins.pair(), settings(alternative, threads), patches, some, monitor, 0.0, 0.6, 1.0);
    }

    static Eigen::Matrix3d half_turn() { return Eigen::Vector3d(-1.0, -1.0, 1.0).asDiagonal(); }

    static shapes::Shape shape() {
        shapes::Shape shape = shapes::sphere(4);
        for (Eigen::Index v = 0; v < shape.vertices.rows(); ++v) {
            const Eigen::Vector3d p = shape.vertices.row(v);
            const double even = 0.25 * p.x() * p.x() - 0.3 * p.x() * p.y() + 0.15 * std::sin(3.0 * p.z() + 1.0) +
                                0.1 * std::cos(4.0 * p.x() * p.y() + p.z());
            const double odd = 0.06 * std::sin(3.0 * p.x() + p.y());
            shape.vertices.row(v) *= 1.0 + even + odd;
        }
        return shape;
    }
};

const TwoWays& two_ways() {
    static const TwoWays once;
    return once;
}

/// Every other patch of the straight map, and the rest.
std::pair<Core, Core> halves() {
    Core even = two_ways().cores[0];
    Core odd = even;
    int k = 0;
    for (std::size_t i = 0; i < even.member.size(); ++i) {
        if (even.member[i] != 0) (k++ % 2 == 0 ? odd : even).member[i] = 0;
    }
    even.count = odd.count = k / 2;
    return {even, odd};
}

TEST(Blend, TellsTheSameMapFromTwoCoresOnce) {
    const auto [even, odd] = halves();
    const auto answers = two_ways().blended(0.0, {even, two_ways().cores[1], odd});
    ASSERT_EQ(answers.size(), 2U);
    const Overlap overlap = overlap_of(answers[0].map, answers[1].map, few(1).blend.agreement_radius);
    EXPECT_GT(overlap.shared, 100);
    EXPECT_LT(10 * overlap.agreed, 4 * overlap.shared);
}

TEST(Blend, OfSeveralContendersIsEqualBitForBitForAnyNumberOfThreads) {
    const auto one = two_ways().blended(0.0, two_ways().cores, 1);
    const auto three = two_ways().blended(0.0, two_ways().cores, 3);
    ASSERT_EQ(one.size(), 2U);
    expect_equal_bits(one, three);
}

TEST(Blend, KeepsAlternativesThatAreWorthTheShareOfTheBestAskedFor) {
    const auto all = two_ways().blended(0.0, two_ways().cores);
    ASSERT_EQ(all.size(), 2U);
    const double share = all[1].fit / all[0].fit;
    ASSERT_LT(share, 1.0);
    EXPECT_EQ(two_ways().blended(0.99 * share, two_ways().cores).size(), 2U);
    EXPECT_EQ(two_ways().blended(1.0, two_ways().cores).size(), 1U);
    const auto best = two_ways().blended(std::min(1.0, 1.01 * share), two_ways().cores);
    ASSERT_EQ(best.size(), 1U);
    EXPECT_EQ(best[0].map.position, all[0].map.position);
}

/// Samples where they belong, or each where the sample half the list away does.
PartialMap earlier_map(const std::vector<int>& samples, bool right) {
    const int count = twins().pair().source.samples.count();
    const PartialMap truth = twins().true_map(twins().all_samples());
    PartialMap map(count);
    for (const int s : samples) {
        const int there = right ? s : (s + count / 2) % count;
        map.put(twins().pair().target.mesh, s, truth.image[there], truth.rotation[there]);
    }
    return map;
}

/// Whether the right core, if it is there, confirms the map of an earlier search.
bool confirms(const PartialMap& earlier, bool carried, bool own) {
    std::vector<Patch> patches = grown().patches;
    patches.push_back({earlier, 0.0, 0.0});
    std::vector<Core> cores;
    if (own) cores.push_back(grown().right);
    for (Core& core : cores) core.member.push_back(0);
    Core before;
    before.member.assign(patches.size(), 0);
    before.member.back() = 1;
    before.count = 1;
    before.carried = carried;
    cores.push_back(before);
    Monitor monitor;
    return blend(twins().pair(), few(2), patches, cores, monitor, 0.0, 0.6, 1.0).front().confirmed;
}

TEST(Blend, IsConfirmedWhereItComesToTheMapOfAnEarlierSearch) {
    const std::vector<int> all = twins().all_samples();
    const std::vector<int> half(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2));
    EXPECT_TRUE(confirms(earlier_map(all, true), true, true));
    EXPECT_FALSE(confirms(earlier_map(all, true), false, true));
    EXPECT_FALSE(confirms(earlier_map(all, true), true, false));
    EXPECT_FALSE(confirms(earlier_map(half, true), true, true));
    EXPECT_FALSE(confirms(earlier_map(all, false), true, true));
}

TEST(Blend, AsksNoWeakerCoreWhereTwoComeToTheSameMap) {
    PatchSettings hard_to_please = TwoWays::settings(0.0, 2);
    hard_to_please.blend.content = 1.0;
    const auto [even, odd] = halves();
    const auto answers = [&](const std::vector<Core>& cores) {
        Monitor monitor;
        return blend(two_ways().twins.pair(), hard_to_please, two_ways().patches, cores, monitor, 0.0, 0.6, 1.0);
    };
    EXPECT_EQ(answers({even, odd, two_ways().cores[1]}).size(), 1U);
    EXPECT_EQ(answers({even, two_ways().cores[1], odd}).size(), 2U);
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
    expect_equal_bits(one, two);
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

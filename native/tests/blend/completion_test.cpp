// SPDX-License-Identifier: GPL-3.0-or-later
#include "blend/completion.h"

#include <algorithm>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "blend/completion_bench.h"
#include "isograft/errors.h"
#include "twins.h"

namespace isograft {
namespace {

const Twins& twins() { return Twins::of_a_blob(); }

/// Right patches on the lower end of the body alone.
const std::vector<Patch>& low_patches() {
    static const std::vector<Patch> patches = [] {
        const Samples& samples = twins().pair().source.samples;
        std::vector<OrientedMatch> matches;
        for (int s = 0; s < samples.count(); s += 4) {
            if (samples.position[s].y() < -0.1) matches.push_back(twins().true_match(s));
        }
        return right_patches(matches, 8);
    }();
    return patches;
}

struct Bench : CompletionBench {
    Bench() : CompletionBench(low_patches()) {}

    void start() { completion.start({std::vector<char>(low_patches().size(), 1), 1}); }
};

double mean_error(const PartialMap& map) {
    double sum = 0.0;
    for (const int s : twins().all_samples()) {
        if (map.mapped[s]) sum += twins().error(s, map.position[s]);
    }
    return sum / map.count;
}

/// The true map with one sample of twelve put where another belongs.
PartialMap spoiled(std::vector<char>& wrong) {
    PartialMap map = twins().true_map(twins().all_samples());
    const int count = twins().pair().source.samples.count();
    wrong.assign(count, 0);
    for (int s = 0; s < count; s += 12) {
        const OrientedMatch match = twins().true_match((s + count / 2) % count);
        map.put(twins().pair().target.mesh, s, match.point, match.rotation);
        wrong[s] = twins().error(s, map.position[s]) > 3.0 ? 1 : 0;
    }
    return map;
}

TEST(Completion, StartsWithWhatTheCoresPatchesHold) {
    Bench bench;
    bench.start();
    const PartialMap& map = bench.completion.map();
    EXPECT_GT(map.count, 40);
    EXPECT_LT(mean_error(map), 0.3);
    for (const int s : twins().all_samples()) {
        const bool held = std::any_of(low_patches().begin(), low_patches().end(),
                                      [&](const Patch& p) { return p.map.mapped[s] != 0; });
        if (map.mapped[s]) {
            EXPECT_TRUE(held);
        }
    }
}

TEST(Completion, IsWorthLessWhereItIsTorn) {
    Bench bench;
    std::vector<char> wrong;
    bench.completion.map() = twins().true_map(twins().all_samples());
    EXPECT_DOUBLE_EQ(bench.completion.worth(), choice_score(bench.completion.quality()));
    bench.completion.map() = spoiled(wrong);
    EXPECT_LT(bench.completion.worth(), 0.1 * choice_score(bench.completion.quality()));
}

TEST(Completion, SecondPassesReachTheRestAndEndWhereNothingIsLeft) {
    Bench bench;
    bench.start();
    bool gained = true;
    for (int round = 0; round < 6 && gained; ++round) {
        const int before = bench.completion.map().count;
        gained = bench.completion.second_pass(Piece(bench.monitor, 0.0));
        if (gained) {
            EXPECT_GT(bench.completion.map().count, before);
        }
    }
    EXPECT_FALSE(gained);
    EXPECT_GT(bench.completion.map().count, 9 * twins().pair().source.samples.count() / 10);
    EXPECT_LT(mean_error(bench.completion.map()), 0.4);
}

TEST(Completion, GrowsOutwardAndNoFartherThanItMayDoubt) {
    Bench careful, free;
    careful.start();
    free.start();
    const PartialMap before = careful.completion.map();
    careful.completion.extend(0.02);
    free.completion.extend(1.0);
    EXPECT_GT(free.completion.map().count, before.count);
    EXPECT_LE(careful.completion.map().count, free.completion.map().count);
    EXPECT_LT(mean_error(free.completion.map()), 0.5);
}

TEST(Completion, DoubtsWhatIsWrongMoreThanWhatIsRight) {
    std::vector<char> wrong;
    Bench bench;
    bench.completion.map() = spoiled(wrong);
    ASSERT_TRUE(bench.completion.place_anchors());
    const PartialMap& map = bench.completion.map();
    double of_wrong = 0.0;
    double of_right = 0.0;
    int wrongs = 0;
    for (const int s : twins().all_samples()) {
        const double doubt_of_it = doubt(bench.completion.evidence(s, map.image[s], map.rotation[s]));
        EXPECT_GE(doubt_of_it, 0.0);
        EXPECT_LE(doubt_of_it, 1.0);
        (wrong[s] ? of_wrong : of_right) += doubt_of_it;
        wrongs += wrong[s];
    }
    ASSERT_GT(wrongs, 10);
    EXPECT_GT(of_wrong / wrongs, 5.0 * of_right / (map.count - wrongs));
}

TEST(Completion, DoubtsNothingThatIsNotMapped) {
    Bench bench;
    bench.start();
    ASSERT_TRUE(bench.completion.place_anchors());
    const auto doubts = bench.completion.doubts();
    for (const int s : twins().all_samples()) {
        if (!bench.completion.map().mapped[s]) {
            EXPECT_EQ(doubts[s], 0.0);
        }
    }
}

TEST(Completion, TrimsMoreAtALowerLimitAndNothingAtOne) {
    std::vector<char> wrong;
    const PartialMap start = spoiled(wrong);
    std::vector<char> before = start.mapped;
    for (const double limit : {1.0, 0.4, 0.05}) {
        Bench bench;
        bench.completion.map() = start;
        bench.completion.trim(limit);
        const PartialMap& map = bench.completion.map();
        if (limit == 1.0) {
            EXPECT_EQ(map.count, start.count);
        }
        for (const int s : twins().all_samples()) EXPECT_LE(map.mapped[s], before[s]);
        before = map.mapped;
    }
    EXPECT_LT(std::count(before.begin(), before.end(), 1), start.count);
}

TEST(Completion, HearsThoseWhoContradictMoreThanThoseWhoAreSilent) {
    const PartialMap map = twins().true_map(twins().all_samples());
    std::vector<char> wrong;
    const auto hearsay = [&](const PartialMap& witness, int s) {
        Bench bench;
        bench.completion.map() = map;
        EXPECT_TRUE(bench.completion.place_anchors());
        bench.completion.hear({witness});
        return bench.completion.evidence(s, map.image[s], map.rotation[s]).hearsay;
    };
    const PartialMap liar = spoiled(wrong);
    const int s = static_cast<int>(std::find(wrong.begin(), wrong.end(), 1) - wrong.begin());
    ASSERT_LT(s, static_cast<int>(wrong.size()));
    EXPECT_EQ(hearsay(map, s), 0.0);
    EXPECT_GT(hearsay(twins().true_map({}), s), 0.0);
    EXPECT_GT(hearsay(liar, s), hearsay(twins().true_map({}), s));
}

TEST(Completion, StopsWhenCancelled) {
    Bench bench;
    bench.monitor.cancel();
    EXPECT_THROW(bench.start(), Cancelled);
}

TEST(Completion, IsEqualBitForBitWithThreadsOfItsOwn) {
    Bench alone, helped;
    helped.completion.take_threads(2);
    for (Bench* bench : {&alone, &helped}) {
        bench->start();
        bench->completion.second_pass(bench->monitor);
        bench->completion.extend(0.5);
        bench->completion.place_anchors();
    }
    EXPECT_GT(alone.completion.map().count, 100);
    EXPECT_EQ(alone.completion.map().mapped, helped.completion.map().mapped);
    EXPECT_EQ(alone.completion.map().rotation, helped.completion.map().rotation);
    EXPECT_EQ(alone.completion.doubts(), helped.completion.doubts());
}

}  // namespace
}  // namespace isograft

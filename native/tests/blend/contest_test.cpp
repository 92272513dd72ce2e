// SPDX-License-Identifier: GPL-3.0-or-later
#include "blend/contest.h"

#include <algorithm>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "blend/completion_bench.h"
#include "blend/vacancy.h"
#include "twins.h"

namespace isograft {
namespace {

const Twins& twins() { return Twins::of_a_blob(); }

constexpr double end = 0.45;
constexpr double small_end = 0.3;

double distance(int a, int b) {
    const Samples& source = twins().pair().source.samples;
    return (source.position[a] - source.position[b]).norm();
}

int other_end() {
    int best = 0;
    for (const int s : twins().all_samples()) {
        if (distance(s, 0) > distance(best, 0)) best = s;
    }
    return best;
}

std::vector<int> samples_near(int centre, double radius = end) {
    std::vector<int> result;
    for (const int s : twins().all_samples()) {
        if (distance(s, centre) < radius) result.push_back(s);
    }
    return result;
}

/// Share of the samples around `centre` that a map puts where they belong.
double share_right(const PartialMap& map, int centre, double radius = end) {
    const std::vector<int> near = samples_near(centre, radius);
    const auto right = std::count_if(
        near.begin(), near.end(), [&](int s) { return map.mapped[s] != 0 && twins().error(s, map.position[s]) < 1.0; });
    return static_cast<double>(right) / static_cast<double>(near.size());
}

/// Right patches all over the body.
const std::vector<Patch>& patches() {
    static const std::vector<Patch> result = [] {
        std::vector<OrientedMatch> matches;
        for (int s = 0; s < twins().pair().source.samples.count(); s += 5) matches.push_back(twins().true_match(s));
        return right_patches(matches, 40);
    }();
    return result;
}

struct Bench : CompletionBench {
    Bench() : CompletionBench(patches()) {}

    std::unique_ptr<Completion> run(std::unique_ptr<Completion> from, int threads) {
        settings.threads = threads;
        const double worth = from->worth();
        return contest(std::move(from), worth, twins().pair(), settings, Piece(monitor));
    }
    std::unique_ptr<Completion> run(int threads) { return run(std::make_unique<Completion>(completion), threads); }
};

/// The true map but for one end, whose samples lie on those of the other end: that end of T stays empty.
PartialMap one_end_on_the_other() {
    PartialMap map = twins().true_map(twins().all_samples());
    const std::vector<int> there = samples_near(0);
    std::size_t next = 0;
    for (const int s : samples_near(other_end())) {
        const OrientedMatch match = twins().true_match(there[next++ % there.size()]);
        map.put(twins().pair().target.mesh, s, match.point, match.rotation);
    }
    return map;
}

/// The true map but for two ends, each of which lies on the other: nothing of T stays empty.
PartialMap ends_exchanged() {
    PartialMap map = twins().true_map(twins().all_samples());
    const std::vector<int> two[] = {samples_near(0, small_end), samples_near(other_end(), small_end)};
    for (int side = 0; side < 2; ++side) {
        const std::vector<int>& from = two[side];
        const std::vector<int>& to = two[1 - side];
        for (std::size_t i = 0; i < from.size(); ++i) {
            const OrientedMatch match = twins().true_match(to[i * to.size() / from.size()]);
            map.put(twins().pair().target.mesh, from[i], match.point, match.rotation);
        }
    }
    return map;
}

const PartialMap& contested() {
    static const PartialMap map = [] {
        Bench bench;
        bench.completion.map() = one_end_on_the_other();
        return bench.run(1)->map();
    }();
    return map;
}

TEST(Contest, LeavesAWholeMapAlone) {
    Bench bench;
    bench.completion.map() = twins().true_map(twins().all_samples());
    auto completion = std::make_unique<Completion>(bench.completion);
    const Completion* before = completion.get();
    const std::unique_ptr<Completion> after = bench.run(std::move(completion), 1);
    EXPECT_EQ(after.get(), before);
    EXPECT_EQ(after->map().count, static_cast<int>(twins().all_samples().size()));
}

TEST(Contest, BringsBackAnEndThatLayOnTheOther) {
    Bench bench;
    bench.completion.be_exclusive();
    bench.completion.map() = one_end_on_the_other();
    const double before = choice_score(bench.completion.quality());
    bench.completion.map() = contested();
    EXPECT_GT(choice_score(bench.completion.quality()), before);
    ASSERT_GT(samples_near(other_end()).size(), 20U);
    EXPECT_GT(share_right(contested(), other_end()), 0.9);
}

TEST(Contest, BringsBackTwoEndsThatWereExchanged) {
    Bench bench;
    bench.completion.map() = ends_exchanged();
    ASSERT_LT(share_right(bench.completion.map(), 0, small_end), 0.1);
    ASSERT_TRUE(vacant_parts(twins().pair(), bench.completion.map(), 0.01).empty());
    EXPECT_EQ(bench.completion.disputed_parts(0.02).size(), 2U);
    const std::unique_ptr<Completion> after = bench.run(1);
    EXPECT_GT(share_right(after->map(), 0, small_end), 0.9);
    EXPECT_GT(share_right(after->map(), other_end(), small_end), 0.9);
}

TEST(Contest, IsTheSameWithOneThreadAndWithTwo) {
    Bench bench;
    bench.completion.map() = one_end_on_the_other();
    const PartialMap map = bench.run(2)->map();
    EXPECT_EQ(map.mapped, contested().mapped);
    EXPECT_EQ(map.position, contested().position);
}

}  // namespace
}  // namespace isograft

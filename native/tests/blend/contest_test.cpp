// SPDX-License-Identifier: GPL-3.0-or-later
#include "blend/contest.h"

#include <algorithm>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "blend/completion_bench.h"
#include "twins.h"

namespace isograft {
namespace {

const Twins& twins() { return Twins::of_a_blob(); }

constexpr double end = 0.45;

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
        return contest(std::move(from), twins().pair(), settings, Piece(monitor));
    }
    std::unique_ptr<Completion> run(int threads) { return run(std::make_unique<Completion>(completion), threads); }
};

/// The true map but for one end, whose samples lie on those of the other end: that end of T stays empty.
PartialMap one_end_on_the_other() {
    PartialMap map = twins().true_map(twins().all_samples());
    std::vector<int> there;
    for (const int s : twins().all_samples()) {
        if (distance(s, 0) < end) there.push_back(s);
    }
    std::size_t next = 0;
    for (const int s : twins().all_samples()) {
        if (distance(s, other_end()) >= end) continue;
        const OrientedMatch match = twins().true_match(there[next++ % there.size()]);
        map.put(twins().pair().target.mesh, s, match.point, match.rotation);
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
    int right = 0;
    int count = 0;
    for (const int s : twins().all_samples()) {
        if (distance(s, other_end()) >= end) continue;
        ++count;
        right += contested().mapped[s] && twins().error(s, contested().position[s]) < 1.0 ? 1 : 0;
    }
    ASSERT_GT(count, 20);
    EXPECT_GT(right, 9 * count / 10);
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

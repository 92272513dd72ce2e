// SPDX-License-Identifier: GPL-3.0-or-later
// What must hold of every run of match(), however many threads it has and whenever it is stopped.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <ctime>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "base/random.h"
#include "gate.h"
#include "isograft/errors.h"
#include "isograft/match.h"
#include "shapes.h"

namespace isograft {
namespace {

MatchOptions quick() {
    MatchOptions options = preset_options("fast");
    options.hierarchy.samples = 250;
    options.hierarchy.min_samples = 200;
    options.seed.probes = 40;
    options.blend.patches = 20;
    options.scale.mode = ScaleMode::fixed;
    options.threads = 1;
    return options;
}

// Seconds of all threads of this process: what another process does at the time does not count.
double busy_seconds() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

TEST(Match, IsEqualBitForBitOverTwentyRunsWithOneTwoAndEightThreads) {
    const Surface source = gate(shapes::blob(3)), target = gate(shapes::noisy(shapes::blob(3), 0.005, 1));
    MatchOptions options = quick();
    const Match first = match(source, target, options);
    ASSERT_GT((first.best().face.array() >= 0).count(), 300);
    for (int run = 1; run < 20; ++run) {
        options.threads = std::vector<int>{1, 2, 8}[run % 3];
        const Match again = match(source, target, options);
        ASSERT_EQ(again.correspondences.size(), first.correspondences.size());
        for (std::size_t i = 0; i < first.correspondences.size(); ++i) {
            const Correspondence &a = first.correspondences[i], &b = again.correspondences[i];
            ASSERT_EQ(a.face, b.face) << run;
            ASSERT_EQ(a.region, b.region) << run;
            ASSERT_EQ(a.confidence, b.confidence) << run;
            for (Eigen::Index v = 0; v < a.face.size(); ++v) {
                if (a.face[v] >= 0) ASSERT_EQ(a.barycentric.row(v), b.barycentric.row(v)) << run << ", vertex " << v;
            }
        }
    }
}

// Both gates and the match, as one call.
void run_all(const shapes::Shape& source, const shapes::Shape& target, const MatchOptions& options, Monitor& monitor) {
    const Surface s = Surface::from_mesh(source.vertices, source.faces, &monitor, 0.0);
    const Surface t = Surface::from_mesh(target.vertices, target.faces, &monitor, 0.0);
    match(s, t, options, &monitor);
}

TEST(Match, StopsWithinAFifthOfASecondAtNinetyNineOfAHundredRandomMoments) {
    // Above the size that is matched as it is.
    const shapes::Shape source = shapes::blob(4), target = shapes::noisy(shapes::blob(4), 0.005, 1);
    const MatchOptions options = quick();
    const double begin = busy_seconds();
    Monitor silent;
    run_all(source, target, options, silent);
    const double whole = busy_seconds() - begin;
    Random random(1);
    std::vector<double> waits;
    for (int i = 0; i < 100; ++i) {
        Monitor monitor;
        const double moment = busy_seconds() + whole * random.uniform();
        std::atomic<double> asked{0.0};
        std::atomic<bool> ended{false};
        std::thread other([&] {
            while (!ended && busy_seconds() < moment) std::this_thread::sleep_for(std::chrono::microseconds(500));
            asked = busy_seconds();
            monitor.cancel();
        });
        try {
            run_all(source, target, options, monitor);
            waits.push_back(0.0);
        } catch (const Cancelled&) {
            waits.push_back(busy_seconds() - asked);
        }
        ended = true;
        other.join();
    }
    std::sort(waits.begin(), waits.end());
    EXPECT_GT(std::count_if(waits.begin(), waits.end(), [](double w) { return w > 0.0; }), 70);
    EXPECT_LT(waits[98], 0.2);
}

}  // namespace
}  // namespace isograft

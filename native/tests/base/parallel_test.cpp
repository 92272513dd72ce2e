// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/parallel.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <mutex>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "base/random.h"
#include "isograft/errors.h"

namespace isograft {
namespace {

TEST(ParallelFor, RunsEveryIndexOnceForAnyNumberOfThreads) {
    for (const int threads : {1, 2, 3, 8}) {
        std::vector<std::atomic<int>> runs(1000);
        Monitor monitor;
        parallel_for(1000, threads, [&](int i, int) { ++runs[i]; }, monitor, "stage", 0.0, 1.0);
        for (const auto& r : runs) EXPECT_EQ(r, 1);
    }
}

TEST(ParallelFor, GivesTheSameBitsForAnyNumberOfThreads) {
    const auto compute = [](int threads) {
        std::vector<double> slot(500);
        Monitor monitor;
        parallel_for(
            500, threads,
            [&](int i, int) {
                Random random(i);
                for (int k = 0; k < 100; ++k) slot[i] += random.uniform() / (k + 1);
            },
            monitor, "stage", 0.0, 1.0);
        return slot;
    };
    const auto one = compute(1);
    EXPECT_EQ(one, compute(2));
    EXPECT_EQ(one, compute(7));
}

TEST(ParallelFor, NumbersWorkersBelowTheNumberOfThreads) {
    Monitor monitor;
    std::atomic<bool> bad{false};
    parallel_for(200, 3, [&](int, int worker) { bad = bad || worker < 0 || worker >= 3; }, monitor, "s", 0.0, 1.0);
    EXPECT_FALSE(bad);
}

TEST(ParallelFor, PassesOnAnExceptionOfAnyWorker) {
    for (const int threads : {1, 2, 4}) {
        Monitor monitor;
        EXPECT_THROW(parallel_for(
                         100, threads,
                         [](int i, int) {
                             if (i == 57) throw std::domain_error("57");
                         },
                         monitor, "stage", 0.0, 1.0),
                     std::domain_error);
    }
}

TEST(ParallelFor, PassesOnTheExceptionOfTheLowestIndexThatRan) {
    Monitor monitor;
    try {
        // One thread runs in order, so that index 3 is the only one to throw.
        parallel_for(
            100, 1,
            [](int i, int) {
                if (i >= 3) throw std::out_of_range(std::to_string(i));
            },
            monitor, "s", 0.0, 1.0);
        FAIL() << "nothing was thrown";
    } catch (const std::out_of_range& e) {
        EXPECT_STREQ(e.what(), "3");
    }
}

TEST(ParallelFor, StopsInTheMiddleWhenCancelledFromAnotherThread) {
    for (const int threads : {1, 3}) {
        Monitor monitor;
        std::atomic<int> runs{0};
        const auto task = [&](int i, int) {
            ++runs;
            if (i == 20) monitor.cancel();
        };
        EXPECT_THROW(parallel_for(100000, threads, task, monitor, "stage", 0.0, 1.0), Cancelled);
        EXPECT_GT(runs, 20);
        EXPECT_LT(runs, 100000);
    }
}

TEST(ParallelFor, DoesNoWorkWhenCancelledBefore) {
    Monitor monitor;
    monitor.cancel();
    std::atomic<int> runs{0};
    EXPECT_THROW(parallel_for(100, 2, [&](int, int) { ++runs; }, monitor, "stage", 0.0, 1.0), Cancelled);
    EXPECT_EQ(runs, 0);
}

TEST(ParallelFor, ReportsOnTheCallingThreadOnlyAndEndsAtItsShare) {
    const auto caller = std::this_thread::get_id();
    std::vector<double> seen;
    bool elsewhere = false;
    Monitor monitor([&](const std::string& stage, double fraction) {
        elsewhere = elsewhere || std::this_thread::get_id() != caller || stage != "stage";
        seen.push_back(fraction);
        return true;
    });
    parallel_for(300, 4, [](int, int) {}, monitor, "stage", 0.25, 0.5);
    parallel_for(0, 4, [](int, int) {}, monitor, "stage", 0.5, 0.75);
    EXPECT_FALSE(elsewhere);
    EXPECT_TRUE(std::is_sorted(seen.begin(), seen.end()));
    EXPECT_GE(seen.front(), 0.25);
    EXPECT_DOUBLE_EQ(seen.back(), 0.75);
}

TEST(ParallelFor, TellsTheProgressOfOthersWhileTheCallerHasNothingLeftToDo) {
    std::vector<double> seen;
    Monitor monitor([&](const std::string&, double fraction) {
        seen.push_back(fraction);
        return true;
    });
    std::atomic<bool> taken{false};
    const auto task = [&](int, int worker) {
        if (worker == 0) {
            while (!taken) std::this_thread::sleep_for(std::chrono::milliseconds(1));
            return;
        }
        taken = true;
        for (int k = 0; k < 4; ++k) {
            std::this_thread::sleep_for(std::chrono::milliseconds(60));
            monitor.add(0.1);
        }
    };
    parallel_for(2, 2, task, monitor, "stage", 0.0, 0.0);
    EXPECT_GE(seen.size(), 4U);
    EXPECT_TRUE(std::is_sorted(seen.begin(), seen.end()));
}

TEST(ParallelFor, WithoutAPartTellsNothingAndCanBeATaskOfAnother) {
    std::set<std::thread::id> tellers;
    std::mutex mutex;
    Monitor monitor([&](const std::string&, double) {
        const std::lock_guard lock(mutex);
        tellers.insert(std::this_thread::get_id());
        return true;
    });
    std::vector<std::atomic<int>> runs(400);
    parallel_for(
        4, 2, [&](int i, int) { parallel_for(100, 2, [&](int j, int) { ++runs[100 * i + j]; }, monitor); }, monitor,
        "stage", 0.2, 0.6);
    for (const auto& count : runs) EXPECT_EQ(count, 1);
    EXPECT_DOUBLE_EQ(monitor.fraction(), 0.6);
    EXPECT_EQ(tellers, std::set<std::thread::id>{std::this_thread::get_id()});
}

}  // namespace
}  // namespace isograft

// SPDX-License-Identifier: GPL-3.0-or-later
#include "isograft/monitor.h"

#include <chrono>
#include <limits>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "isograft/errors.h"

namespace isograft {
namespace {

TEST(Monitor, CancelledBeforeTheStartThrowsAtTheFirstCheckAndCallsNobody) {
    int calls = 0;
    Monitor monitor([&](const std::string&, double) { return ++calls > 0; });
    monitor.cancel();
    EXPECT_TRUE(monitor.cancelled());
    EXPECT_THROW(monitor.check(), Cancelled);
    EXPECT_THROW(monitor.report("stage", 0.5), Cancelled);
    EXPECT_EQ(calls, 0);
}

TEST(Monitor, PassesWhileNobodyAsksToStop) {
    Monitor monitor;
    EXPECT_NO_THROW(monitor.check());
    EXPECT_NO_THROW(monitor.report("stage", 0.5));
    EXPECT_FALSE(monitor.cancelled());
}

TEST(Monitor, IsCancelledForGoodOnceTheCallbackReturnsFalse) {
    Monitor monitor([](const std::string&, double fraction) { return fraction < 0.5; });
    EXPECT_NO_THROW(monitor.report("stage", 0.4));
    EXPECT_THROW(monitor.report("stage", 0.6), Cancelled);
    EXPECT_TRUE(monitor.cancelled());
    EXPECT_THROW(monitor.check(), Cancelled);
}

TEST(Monitor, ThrowsFromTheReportDuringWhichAnotherCancels) {
    Monitor* self = nullptr;
    Monitor monitor([&](const std::string&, double) {
        self->cancel();
        return true;
    });
    self = &monitor;
    EXPECT_THROW(monitor.report("stage", 0.1), Cancelled);
}

TEST(Monitor, ReportsFractionsInTheUnitIntervalThatNeverFall) {
    std::vector<double> seen;
    std::vector<std::string> stages;
    Monitor monitor([&](const std::string& stage, double fraction) {
        stages.push_back(stage);
        seen.push_back(fraction);
        return true;
    });
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const double f : {-1.0, 0.2, 0.1, nan, 0.7, 0.6, 5.0, 0.9}) monitor.report("a", f);
    monitor.report("b", 1.0);
    EXPECT_EQ(seen, (std::vector<double>{0.0, 0.2, 0.2, 0.2, 0.7, 0.7, 1.0, 1.0, 1.0}));
    EXPECT_EQ(stages.front(), "a");
    EXPECT_EQ(stages.back(), "b");
}

TEST(Monitor, PassesOnWhatTheCallbackThrows) {
    Monitor monitor([](const std::string&, double) -> bool { throw std::runtime_error("from the caller"); });
    EXPECT_THROW(monitor.report("stage", 0.1), std::runtime_error);
}

TEST(Monitor, TellsTheReportingThreadWhatOthersAdd) {
    std::vector<double> seen;
    const auto reporter = std::this_thread::get_id();
    bool elsewhere = false;
    Monitor monitor([&](const std::string&, double fraction) {
        elsewhere = elsewhere || std::this_thread::get_id() != reporter;
        seen.push_back(fraction);
        return true;
    });
    monitor.report("stage", 0.25);
    std::thread other([&] {
        for (int i = 0; i < 100; ++i) monitor.add(0.0025);
    });
    other.join();
    EXPECT_EQ(seen.size(), 1U);
    EXPECT_NEAR(monitor.fraction(), 0.5, 1e-12);
    std::this_thread::sleep_for(std::chrono::milliseconds(60));
    monitor.check();
    ASSERT_EQ(seen.size(), 2U);
    EXPECT_NEAR(seen.back(), 0.5, 1e-12);
    const auto told = std::chrono::steady_clock::now();
    monitor.check();
    if (std::chrono::steady_clock::now() - told < std::chrono::milliseconds(40)) EXPECT_EQ(seen.size(), 2U);
    EXPECT_FALSE(elsewhere);
}

TEST(Monitor, NeverTellsMoreThanTheWhole) {
    double last = 0.0;
    Monitor monitor([&](const std::string&, double fraction) {
        last = fraction;
        return true;
    });
    monitor.report("stage", 0.9);
    monitor.add(0.3);
    monitor.report("stage", 0.95);
    EXPECT_EQ(last, 1.0);
}

TEST(Monitor, IsCancelledFromACheckWhoseCallbackReturnsFalse) {
    int calls = 0;
    Monitor monitor([&](const std::string&, double) { return ++calls < 2; });
    monitor.report("stage", 0.1);
    std::this_thread::sleep_for(std::chrono::milliseconds(60));
    EXPECT_THROW(monitor.check(), Cancelled);
    EXPECT_TRUE(monitor.cancelled());
}

}  // namespace
}  // namespace isograft

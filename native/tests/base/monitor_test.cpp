// SPDX-License-Identifier: GPL-3.0-or-later
#include "isograft/monitor.h"

#include <limits>
#include <string>
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

}  // namespace
}  // namespace isograft

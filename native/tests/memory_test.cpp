// SPDX-License-Identifier: GPL-3.0-or-later
#include "isograft/memory.h"

#include <string>

#include <gtest/gtest.h>

#include "gate.h"
#include "isograft/errors.h"
#include "shapes.h"

namespace isograft {
namespace {

constexpr MeshSize small{5'000, 10'000}, large{1'000'000, 2'000'000};

TEST(EstimatedMemory, RisesWithSizeSamplesAndThreadsAndStaysBelowTheBoundForAMillionVertices) {
    MatchOptions options;
    options.threads = 1;
    const std::int64_t one = estimated_memory(small, small, options);
    EXPECT_LT(one, estimated_memory(large, small, options));
    EXPECT_EQ(estimated_memory(small, large, options), estimated_memory(large, small, options));
    EXPECT_LT(estimated_memory(large, large, options), 8'000'000'000);
    options.threads = 4;
    EXPECT_LT(one, estimated_memory(small, small, options));
    options.threads = 1;
    options.hierarchy.samples = 2000;
    EXPECT_LT(one, estimated_memory(small, small, options));
}

TEST(CheckMemory, RefusesWithBothNumbersAndOnlyAboveTheLimit) {
    const MatchOptions options;
    const std::int64_t need = estimated_memory(small, large, options);
    EXPECT_NO_THROW(check_memory(small, large, options, 0));
    EXPECT_NO_THROW(check_memory(small, large, options, need));
    try {
        check_memory(small, large, options, 100'000'000);
        FAIL() << "nothing was thrown";
    } catch (const ResourceLimit& e) {
        const std::string text = e.what();
        EXPECT_NE(text.find("5000 to 1000000 vertices"), std::string::npos) << text;
        EXPECT_NE(text.find(std::to_string((need + 999'999) / 1'000'000) + " MB"), std::string::npos) << text;
        EXPECT_NE(text.find("limit is 100 MB"), std::string::npos) << text;
    }
}

TEST(CheckMemory, IsAskedBeforeAMatchBegins) {
    const Surface surface = gate(shapes::blob(2));
    MatchOptions options;
    options.memory_limit = 1'000'000;
    int reports = 0;
    Monitor monitor([&](const std::string&, double) { return ++reports > 0; });
    EXPECT_THROW(match(surface, surface, options, &monitor), ResourceLimit);
    EXPECT_EQ(reports, 0);
    options.memory_limit = -1;
    EXPECT_THROW(options.validate(), InvalidInput);
}

}  // namespace
}  // namespace isograft

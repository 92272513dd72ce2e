// SPDX-License-Identifier: GPL-3.0-or-later
#include "blend/core.h"

#include <vector>

#include <gtest/gtest.h>

#include "made_patch.h"

namespace isograft {
namespace {

const BlendOptions options;

// Three that are right, four that are not, and agree among themselves.
std::vector<Patch> few_right_among_more_wrong() {
    std::vector<Patch> patches;
    for (int i = 0; i < 7; ++i) {
        patches.push_back(i < 3 ? made_patch(everywhere, where_it_belongs) : made_patch(everywhere, at_the_other_end));
    }
    return patches;
}

TEST(Cores, AreWhatAgreesTheStrongestFirst) {
    const auto cores = find_cores(few_right_among_more_wrong(), options);
    ASSERT_EQ(cores.size(), 2u);
    EXPECT_EQ(cores[0].member, (std::vector<char>{0, 0, 0, 1, 1, 1, 1}));
    EXPECT_EQ(cores[1].member, (std::vector<char>{1, 1, 1, 0, 0, 0, 0}));
    EXPECT_EQ(cores[0].count, 4);
    EXPECT_EQ(cores[1].count, 3);
}

TEST(Cores, BeginAtALandmarkHoweverFewAgreeWithIt) {
    const auto cores = find_cores(few_right_among_more_wrong(), options, 2);
    ASSERT_EQ(cores.size(), 2u);
    EXPECT_EQ(cores[0].member, (std::vector<char>{1, 1, 1, 0, 0, 0, 0}));
    EXPECT_EQ(cores[1].member, (std::vector<char>{0, 0, 0, 1, 1, 1, 1}));
}

TEST(Cores, MayHoldTheLandmarkAlone) {
    std::vector<Patch> patches = few_right_among_more_wrong();
    patches.erase(patches.begin() + 1, patches.begin() + 3);
    const auto cores = find_cores(patches, options, 1);
    ASSERT_EQ(cores.size(), 2u);
    EXPECT_EQ(cores[0].member, (std::vector<char>{1, 0, 0, 0, 0}));
    EXPECT_EQ(cores[1].member, (std::vector<char>{0, 1, 1, 1, 1}));
}

TEST(Cores, AreNoneWithoutPatches) { EXPECT_TRUE(find_cores({}, options).empty()); }

}  // namespace
}  // namespace isograft

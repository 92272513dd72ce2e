// SPDX-License-Identifier: GPL-3.0-or-later
// When match() searches again, and what comes of it.
#include <gtest/gtest.h>

#include "gate.h"
#include "isograft/match.h"
#include "matches.h"
#include "shapes.h"

namespace isograft {
namespace {

using matches::expect_same_bits;
using matches::quick;
using matches::Score;
using matches::score;
using matches::spacing;
using shapes::bumped;

/// Content with nothing: it searches again as long as it may.
MatchOptions hard_to_please() {
    MatchOptions options = quick();
    options.blend.content = 1.0;
    options.scale.mode = ScaleMode::fixed;
    return options;
}

TEST(Match, LosesNothingByAnotherSearch) {
    const shapes::Shape target = bumped();
    const Surface source = gate(shapes::blob(4));
    MatchOptions options = hard_to_please();
    const Match once = match(source, gate(target), options);
    options.blend.attempts = 3;
    const Match again = match(source, gate(target), options);
    EXPECT_GT(again.report.maps_grown, once.report.maps_grown);
    const double radius = 1.5 * spacing(source.mesh(), options);
    const Score before = score(once.best(), target.vertices, radius);
    const Score after = score(again.best(), target.vertices, radius);
    EXPECT_GE(after.right, before.right);
    EXPECT_GT(after.right, 0.9 * after.matched);
    options.threads = 1;
    expect_same_bits(match(source, gate(target), options).best().points, again.best().points);
}

TEST(Match, SearchesNoMoreWhereASecondSearchComesToTheSameMap) {
    const Surface source = gate(shapes::blob(4)), target = gate(bumped());
    MatchOptions options = hard_to_please();
    const Match once = match(source, target, options);
    options.blend.attempts = 2;
    const Match twice = match(source, target, options);
    ASSERT_GT(twice.report.maps_grown, once.report.maps_grown);
    options.blend.attempts = 6;
    const Match open = match(source, target, options);
    EXPECT_EQ(open.report.maps_grown, twice.report.maps_grown);
    expect_same_bits(open.best().points, twice.best().points);
}

TEST(Match, SearchesOnWhereTwoSearchesDoNotAgree) {
    // So rough that no search finds a map that another one would find again.
    const Surface source = gate(shapes::blob(4)), target = gate(shapes::noisy(bumped(), 0.06, 3));
    MatchOptions options = hard_to_please();
    options.blend.attempts = 2;
    const Match twice = match(source, target, options);
    options.blend.attempts = 3;
    const Match thrice = match(source, target, options);
    EXPECT_GT(thrice.report.maps_grown, twice.report.maps_grown);
    options.threads = 1;
    expect_same_bits(match(source, target, options).best().points, thrice.best().points);
}

}  // namespace
}  // namespace isograft

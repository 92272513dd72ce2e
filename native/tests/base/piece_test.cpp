// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/piece.h"

#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "isograft/errors.h"

namespace isograft {
namespace {

TEST(Piece, AddsWhatItReachesOnceAndNeverFallsBack) {
    Monitor monitor;
    Piece piece(monitor, 0.5);
    piece.reach(0.4);
    piece.reach(0.2);
    piece.reach(0.4);
    EXPECT_DOUBLE_EQ(monitor.fraction(), 0.2);
    piece.reach(1.0);
    EXPECT_DOUBLE_EQ(monitor.fraction(), 0.5);
}

TEST(Piece, PartsFillTheWholeWhoeverFillsThem) {
    Monitor monitor;
    Piece piece(monitor, 1.0);
    Piece first = piece.until(0.3);
    EXPECT_DOUBLE_EQ(monitor.fraction(), 0.0);
    Piece second = piece.until(0.8);
    second.reach(1.0);
    EXPECT_DOUBLE_EQ(monitor.fraction(), 0.5);
    first.reach(0.5);
    EXPECT_DOUBLE_EQ(monitor.fraction(), 0.65);
    EXPECT_DOUBLE_EQ(piece.until(0.5).monitor().fraction(), 0.65);
    piece.reach(1.0);
    EXPECT_DOUBLE_EQ(monitor.fraction(), 0.85);
}

TEST(Piece, AddsUpOverThreads) {
    Monitor monitor;
    std::vector<std::thread> threads;
    for (int t = 0; t < 4; ++t) {
        threads.emplace_back([&] {
            Piece piece(monitor, 0.25);
            for (int i = 1; i <= 1000; ++i) piece.reach(i / 1000.0);
        });
    }
    for (auto& thread : threads) thread.join();
    EXPECT_NEAR(monitor.fraction(), 1.0, 1e-9);
}

TEST(Piece, SplitsIntoEqualPiecesThatFillIt) {
    Monitor monitor;
    Piece piece(monitor, 1.0);
    std::vector<Piece> pieces = piece.split(0.6, 3);
    ASSERT_EQ(pieces.size(), 3U);
    EXPECT_DOUBLE_EQ(monitor.fraction(), 0.0);
    for (Piece& p : pieces) p.reach(0.5);
    EXPECT_DOUBLE_EQ(monitor.fraction(), 0.3);
    for (Piece& p : pieces) p.reach(1.0);
    EXPECT_DOUBLE_EQ(monitor.fraction(), 0.6);
    EXPECT_TRUE(piece.split(0.8, 0).empty());
    piece.reach(1.0);
    EXPECT_DOUBLE_EQ(monitor.fraction(), 0.8);
}

TEST(Piece, WithoutSizeOnlyChecks) {
    Monitor monitor;
    Piece piece(monitor);
    piece.reach(0.5);
    EXPECT_EQ(monitor.fraction(), 0.0);
    monitor.cancel();
    EXPECT_THROW(piece.reach(0.5), Cancelled);
    EXPECT_THROW(piece.reach(0.7), Cancelled);
    EXPECT_THROW(piece.check(), Cancelled);
}

}  // namespace
}  // namespace isograft

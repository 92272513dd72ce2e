// SPDX-License-Identifier: GPL-3.0-or-later
#include "seed/oriented_match.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include <gtest/gtest.h>

#include "isograft/errors.h"
#include "shapes.h"
#include "twins.h"

namespace isograft {
namespace {

std::vector<OrientedMatch> found(const SeedOptions& options, int threads) {
    const Twins& twins = Twins::of_a_blob();
    Monitor monitor;
    return oriented_matches(twins.pair(), twins.options().feature, options, threads, monitor, 0.0, 1.0);
}

/// At the right place, to within the samples' spacing, and turned to within a right angle's half.
bool is_right(const OrientedMatch& match) {
    const Twins& twins = Twins::of_a_blob();
    const TriangleMesh& target = twins.pair().target.mesh;
    if (twins.error(match.sample, position(target, match.point)) > 1.5) return false;
    const OrientedMatch truth = twins.true_match(match.sample);
    const Complex turn = carry(target, truth.point.face, match.point.face, truth.rotation);
    return std::abs(std::arg(match.rotation * std::conj(turn))) < 0.8;
}

double share_right(const std::vector<OrientedMatch>& matches, std::size_t from, std::size_t to) {
    const auto begin = matches.begin();
    const auto right = std::count_if(begin + static_cast<std::ptrdiff_t>(from), begin + static_cast<std::ptrdiff_t>(to),
                                     [](const OrientedMatch& m) { return is_right(m); });
    return static_cast<double>(right) / static_cast<double>(to - from);
}

TEST(OrientedMatches, OfABodyAndItsCopyAreRightWhereTheyAreSurest) {
    const auto matches = found({}, 2);
    ASSERT_GT(matches.size(), 40U);
    EXPECT_GT(share_right(matches, 0, 20), 0.9);
    // The score is worth something: the first half has more right ones than the second.
    EXPECT_GT(share_right(matches, 0, matches.size() / 2),
              share_right(matches, matches.size() / 2, matches.size()) + 0.1);
}

TEST(OrientedMatches, ComeInTheOrderOfTheirScoreAndApartFromEachOther) {
    const SeedOptions options;
    const Pair& pair = Twins::of_a_blob().pair();
    const auto matches = found(options, 2);
    EXPECT_TRUE(std::is_sorted(matches.begin(), matches.end(),
                               [](const OrientedMatch& a, const OrientedMatch& b) { return a.score < b.score; }));
    std::map<int, std::vector<Eigen::Vector3d>> images;
    for (const OrientedMatch& m : matches) {
        EXPECT_NEAR(std::abs(m.rotation), 1.0, 1e-9);
        images[m.sample].push_back(position(pair.target.mesh, m.point));
    }
    for (const auto& [sample, places] : images) {
        EXPECT_LE(static_cast<int>(places.size()), options.candidates);
        for (std::size_t i = 0; i < places.size(); ++i) {
            for (std::size_t j = 0; j < i; ++j) {
                EXPECT_GE((places[i] - places[j]).norm(), options.separation * pair.target.samples.spacing);
            }
        }
    }
}

TEST(OrientedMatches, AreEqualBitForBitForAnyNumberOfThreads) {
    const auto one = found({}, 1);
    const auto two = found({}, 2);
    ASSERT_EQ(one.size(), two.size());
    for (std::size_t i = 0; i < one.size(); ++i) {
        EXPECT_EQ(one[i].sample, two[i].sample);
        EXPECT_EQ(one[i].point.face, two[i].point.face);
        EXPECT_EQ(one[i].point.weight, two[i].point.weight);
        EXPECT_EQ(one[i].rotation, two[i].rotation);
        EXPECT_EQ(one[i].score, two[i].score);
    }
}

TEST(OrientedMatches, StopWhenCancelled) {
    const Twins& twins = Twins::of_a_blob();
    Monitor monitor;
    monitor.cancel();
    EXPECT_THROW(oriented_matches(twins.pair(), twins.options().feature, {}, 2, monitor, 0.0, 1.0), Cancelled);
}

TEST(SeedOptions, AreRefusedByName) {
    const auto refusal = [](auto change) {
        SeedOptions options;
        change(options);
        try {
            options.validate();
        } catch (const InvalidInput& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    EXPECT_NE(refusal([](SeedOptions& o) { o.candidates = 0; }).find("candidates"), std::string::npos);
    EXPECT_NE(refusal([](SeedOptions& o) { o.probes = -1; }).find("probes"), std::string::npos);
    EXPECT_NE(refusal([](SeedOptions& o) { o.probe_size = 0; }).find("probe_size"), std::string::npos);
    EXPECT_NE(refusal([](SeedOptions& o) { o.separation = std::nan(""); }).find("separation"), std::string::npos);
    EXPECT_EQ(refusal([](SeedOptions& /*o*/) {}), "");
}

}  // namespace
}  // namespace isograft

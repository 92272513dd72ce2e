// SPDX-License-Identifier: GPL-3.0-or-later
#include "blend/trials.h"

#include <functional>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "twins.h"

namespace isograft {
namespace {

constexpr int size = 30;

TrialSeed some_seed(int source) { return {source, source / 2, 3 * source % descriptor_angles}; }

TEST(Trials, AreWhatAProbeOfTheSameSeedGives) {
    const Pair& pair = Twins::of_a_blob().pair();
    const PatchSettings settings = Twins::of_a_blob().settings();
    Grower grower(pair.source.samples, pair.target, settings.growth);
    Trials trials(pair, settings, size);
    for (const int source : {0, 7, 40}) {
        const TrialSeed seed = some_seed(source);
        const OrientedMatch match{seed.source, pair.target.samples.point[seed.target], rotation_of(seed.shift), 0.0};
        const Patch patch = probe(pair, settings, grower, match, size);
        const Trial& trial = trials.of(seed, grower);
        EXPECT_EQ(static_cast<int>(trial.held.size()), patch.map.count);
        EXPECT_EQ(trial.quality, patch.quality);
        EXPECT_EQ(trial.misfit, mean_mismatch(pair, settings.feature, patch.map));
        const PartialMap map = to_map(trial, seed, pair);
        EXPECT_EQ(map.mapped, patch.map.mapped);
        for (const Trial::Held& h : trial.held) {
            EXPECT_EQ(map.position[h.sample], patch.map.position[h.sample]);
            EXPECT_EQ(map.rotation[h.sample], patch.map.rotation[h.sample]);
        }
        if (map.mapped[seed.source] != 0) {
            EXPECT_EQ(map.seed_distance[seed.source], 0.0F);
        }
    }
}

TEST(Trials, AreMadeOnceAndTheSameForEveryThread) {
    const Pair& pair = Twins::of_a_blob().pair();
    const PatchSettings settings = Twins::of_a_blob().settings();
    Trials trials(pair, settings, size);
    std::vector<const Trial*> first(20), second(20);
    const auto ask = [&](std::vector<const Trial*>& answers) {
        Grower grower(pair.source.samples, pair.target, settings.growth);
        for (int i = 0; i < 20; ++i) answers[i] = &trials.of(some_seed(i % 10), grower);
    };
    std::thread other(ask, std::ref(first));
    ask(second);
    other.join();
    EXPECT_EQ(first, second);
    for (int i = 0; i < 10; ++i) EXPECT_EQ(first[i], first[i + 10]);
}

TEST(Trials, AreTheSamePreparedSideBySide) {
    const Pair& pair = Twins::of_a_blob().pair();
    const PatchSettings settings = Twins::of_a_blob().settings();
    Grower grower(pair.source.samples, pair.target, settings.growth);
    std::vector<TrialSeed> seeds;
    for (int i = 0; i < 12; ++i) seeds.push_back(some_seed(i));
    Trials alone(pair, settings, size), prepared(pair, settings, size);
    Monitor monitor;
    prepared.prepare(seeds, 2, Piece(monitor, 0.5));
    EXPECT_DOUBLE_EQ(monitor.fraction(), 0.5);
    for (const TrialSeed& seed : seeds) {
        const Trial& a = alone.of(seed, grower);
        const Trial& b = prepared.of(seed, grower);
        EXPECT_EQ(a.quality, b.quality);
        ASSERT_EQ(a.held.size(), b.held.size());
        for (std::size_t i = 0; i < a.held.size(); ++i) EXPECT_EQ(a.held[i].position, b.held[i].position);
    }
}

}  // namespace
}  // namespace isograft

// SPDX-License-Identifier: GPL-3.0-or-later
#include "blend/core.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <Eigen/Core>

#include "isograft/errors.h"

namespace isograft {

void BlendOptions::validate() const {
    const auto require = [](bool holds, const std::string& what) {
        if (!holds) throw InvalidInput("blend." + what);
    };
    require(patches >= 1 && patches <= 10000, "patches must be in [1, 10000]");
    require(patch_size >= 8, "patch_size must be at least 8");
    require(agreement_radius > 0.0 && agreement_radius <= 1.0, "agreement_radius must be in (0, 1]");
    require(min_agreement > 0.0 && min_agreement <= 1.0, "min_agreement must be in (0, 1]");
    require(decay > 0.0 && std::isfinite(decay), "decay must be positive");
    require(cores >= 1 && cores <= 100, "cores must be in [1, 100]");
    require(rounds >= 0 && rounds <= 100, "rounds must be in [0, 100]");
    require(anchors >= 3 && anchors <= 64, "anchors must be in [3, 64]");
    require(max_incompatibility > 0.0 && std::isfinite(max_incompatibility), "max_incompatibility must be positive");
    require(accept > 0.0 && accept <= 1.0, "accept must be in (0, 1]");
    require(careful_rounds >= 0 && careful_rounds <= 100, "careful_rounds must be in [0, 100]");
    require(alternative >= 0.0 && alternative <= 1.0, "alternative must be in [0, 1]; 1 keeps none");
    require(attempts >= 1 && attempts <= 100, "attempts must be in [1, 100]");
    require(content >= 0.0 && content <= 1.0, "content must be in [0, 1]; 0 is content with any map");
}

namespace {

struct Agreement {
    /// Weighted number of shared samples, and of those put in the same place.
    Eigen::MatrixXd overlap, agree;
};

struct Held {
    int sample;
    float trust;
};

Agreement measure_agreement(const std::vector<Patch>& patches, const BlendOptions& options) {
    const int count = static_cast<int>(patches.size());
    std::vector<std::vector<Held>> held(count);
    for (int i = 0; i < count; ++i) {
        const PartialMap& map = patches[i].map;
        for (std::size_t s = 0; s < map.mapped.size(); ++s) {
            if (!map.mapped[s]) continue;
            const double trust = std::exp(-map.seed_distance[s] / (4.0 * options.decay));
            held[i].push_back({static_cast<int>(s), static_cast<float>(trust)});
        }
    }
    Agreement result{Eigen::MatrixXd::Zero(count, count), Eigen::MatrixXd::Zero(count, count)};
    const double radius = options.agreement_radius * options.agreement_radius;
    for (int i = 0; i < count; ++i) {
        for (int j = i + 1; j < count; ++j) {
            double overlap = 0.0;
            double agree = 0.0;
            auto a = held[i].begin();
            auto b = held[j].begin();
            while (a != held[i].end() && b != held[j].end()) {
                if (a->sample < b->sample) {
                    ++a;
                } else if (b->sample < a->sample) {
                    ++b;
                } else {
                    const double w = static_cast<double>(a->trust) * b->trust;
                    const Eigen::Vector3d gap = patches[i].map.position[a->sample] - patches[j].map.position[a->sample];
                    overlap += w;
                    if (gap.squaredNorm() < radius) agree += w;
                    ++a;
                    ++b;
                }
            }
            result.overlap(i, j) = result.overlap(j, i) = overlap;
            result.agree(i, j) = result.agree(j, i) = agree;
        }
    }
    return result;
}

Eigen::MatrixXd support(const Agreement& agreement) {
    Eigen::MatrixXd result = Eigen::MatrixXd::Zero(agreement.overlap.rows(), agreement.overlap.cols());
    for (Eigen::Index i = 0; i < result.rows(); ++i) {
        for (Eigen::Index j = 0; j < result.cols(); ++j) {
            const double overlap = agreement.overlap(i, j);
            if (overlap <= 0.05) continue;
            const double share = agreement.agree(i, j) / overlap;
            if (share > 0.5) result(i, j) = 2.0 * (share - 0.5) * std::min(1.0, overlap / 3.0);
        }
    }
    return result;
}

double vote_of(const Patch& patch) { return std::exp(-2.0 * patch.quality); }

// The patch that has most support among those not used yet.
int strongest(const Eigen::MatrixXd& support, const std::vector<Patch>& patches, const std::vector<char>& used) {
    const Eigen::Index count = support.rows();
    Eigen::VectorXd base(count);
    for (Eigen::Index i = 0; i < count; ++i) base[i] = used[i] ? 0.0 : vote_of(patches[i]);
    Eigen::VectorXd x = base;
    for (int step = 0; step < 30; ++step) {
        x = support * x + 0.1 * base;
        for (Eigen::Index i = 0; i < count; ++i) {
            if (used[i]) x[i] = 0.0;
        }
        x /= std::max(1e-300, x.norm());
    }
    Eigen::Index best = 0;
    x.maxCoeff(&best);
    return static_cast<int>(best);
}

}  // namespace

std::vector<Core> find_cores(const std::vector<Patch>& patches, const BlendOptions& options, int forced) {
    const int count = static_cast<int>(patches.size());
    std::vector<Core> cores;
    if (count == 0) return cores;
    const Agreement agreement = measure_agreement(patches, options);
    const Eigen::MatrixXd weights = support(agreement);
    std::vector<char> used(count, 0);
    for (int k = 0; k < options.cores; ++k) {
        const auto left = std::count(used.begin(), used.end(), 0);
        if (left == 0 || (k > 0 && left < 3)) break;
        Core core;
        core.member.assign(count, 0);
        std::vector<char> passed_over = used;
        if (k == 0 && forced > 0) std::fill(passed_over.begin() + forced, passed_over.end(), 1);
        const int first = strongest(weights, patches, passed_over);
        core.member[first] = 1;
        Eigen::VectorXd agree = agreement.agree.col(first);
        Eigen::VectorXd overlap = agreement.overlap.col(first);
        while (true) {
            int best = -1;
            double best_score = 0.0;
            for (int j = 0; j < count; ++j) {
                if (core.member[j] || used[j] || overlap[j] <= 1.0) continue;
                const double share = agree[j] / overlap[j];
                if (share < options.min_agreement) continue;
                const double score = (share - 0.4) * std::min(overlap[j], 10.0);
                if (score > best_score) {
                    best_score = score;
                    best = j;
                }
            }
            if (best < 0) break;
            core.member[best] = 1;
            agree += agreement.agree.col(best);
            overlap += agreement.overlap.col(best);
        }
        for (int i = 0; i < count; ++i) {
            if (core.member[i]) {
                ++core.count;
                used[i] = 1;
            } else if (overlap[i] > 1.0 && agree[i] / overlap[i] > 0.5) {
                used[i] = 1;
            }
        }
        if (core.count < 3 && k > 0) break;
        cores.push_back(std::move(core));
    }
    return cores;
}

}  // namespace isograft

// SPDX-License-Identifier: GPL-3.0-or-later
#include "transfer/galerkin.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "transfer/pace.h"

namespace isograft {

namespace {

constexpr double raised = 1e-12;

// One row of the energy as a function of the parameters.
class Line {
  public:
    Line(const GradedSpace& space, const RowMatrix& rows) : space_(space), rows_(rows), at_(space.group_count(), -1) {}

    // Groups, ascending.
    [[nodiscard]] const std::vector<int>& groups() const { return groups_; }
    [[nodiscard]] const GradedSpace::Parameters& of(int group) const { return shares_[at_[group]]; }

    void read(Eigen::Index row) {
        for (const int group : groups_) at_[group] = -1;
        groups_.clear();
        shares_.clear();
        for (RowMatrix::InnerIterator it(rows_, row); it; ++it) {
            space_.each(it.col(), [&](int group, const GradedSpace::Parameters& parameters) {
                if (at_[group] < 0) {
                    at_[group] = static_cast<int>(shares_.size());
                    groups_.push_back(group);
                    shares_.push_back({});
                }
                GradedSpace::Parameters& sum = shares_[at_[group]];
                for (int k = 0; k < GradedSpace::most; ++k) sum[k] += it.value() * parameters[k];
            });
        }
        std::sort(groups_.begin(), groups_.end());
    }

  private:
    const GradedSpace& space_;
    const RowMatrix& rows_;
    std::vector<int> at_;
    std::vector<int> groups_;
    std::vector<GradedSpace::Parameters> shares_;
};

void tidy(std::vector<int>& list) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
}

// The groups up to each one that share a row with it, ascending.
std::vector<std::vector<int>> partners(const GradedSpace& space, const SquaredRows& energy, Piece piece) {
    std::vector<std::vector<int>> result(space.group_count());
    std::vector<std::size_t> tidied(result.size(), 0);
    Line line(space, energy.rows);
    std::vector<int> before;
    for (Eigen::Index row = 0; row < energy.rows.rows(); ++row) {
        if (row % rows_a_check == 0) piece.reach(static_cast<double>(row) / static_cast<double>(energy.rows.rows()));
        line.read(row);
        if (line.groups() == before) continue;
        before = line.groups();
        for (std::size_t a = 0; a < before.size(); ++a) {
            std::vector<int>& list = result[before[a]];
            list.insert(list.end(), before.begin(), before.begin() + static_cast<std::ptrdiff_t>(a) + 1);
            if (list.size() < 2 * tidied[before[a]] + 64) continue;
            tidy(list);
            tidied[before[a]] = list.size();
        }
    }
    for (std::vector<int>& list : result) tidy(list);
    piece.reach(1.0);
    return result;
}

}  // namespace

RowMatrix energy_within(const GradedSpace& space, const SquaredRows& energy, Piece piece) {
    const std::vector<std::vector<int>> below = partners(space, energy, piece.until(0.3));
    // Of every group a block as wide as all of its partners.
    std::vector<std::vector<double>> block(below.size());
    const auto size = [&](int group) { return space.first(group + 1) - space.first(group); };
    for (std::size_t g = 0; g < below.size(); ++g) {
        std::size_t width = 0;
        for (const int other : below[g]) width += size(other);
        block[g].assign(width * size(static_cast<int>(g)), 0.0);
    }
    Line line(space, energy.rows);
    for (Eigen::Index row = 0; row < energy.rows.rows(); ++row) {
        if (row % rows_a_check == 0) {
            piece.reach(0.3 + 0.7 * static_cast<double>(row) / static_cast<double>(energy.rows.rows()));
        }
        line.read(row);
        for (const int group : line.groups()) {
            const GradedSpace::Parameters& own = line.of(group);
            const int height = size(group);
            double* at = block[group].data();
            auto next = line.groups().begin();
            for (const int other : below[group]) {
                const int width = size(other);
                if (*next == other) {
                    const GradedSpace::Parameters& shares = line.of(other);
                    for (int k = 0; k < height; ++k) {
                        const double factor = energy.weights[row] * own[k];
                        for (int l = 0; l < width; ++l) at[k * width + l] += factor * shares[l];
                    }
                    ++next;
                }
                at += static_cast<std::ptrdiff_t>(height) * width;
            }
        }
    }
    RowMatrix result(space.first(space.group_count()), space.first(space.group_count()));
    for (std::size_t g = 0; g < below.size(); ++g) {
        piece.check();
        const int height = size(static_cast<int>(g));
        for (int k = 0; k < height; ++k) {
            const int row = space.first(static_cast<int>(g)) + k;
            result.startVec(row);
            std::size_t at = 0;
            for (const int other : below[g]) {
                const int width = size(other);
                for (int l = 0; l < width && space.first(other) + l <= row; ++l) {
                    const double value = block[g][at + k * width + l];
                    double& entry = result.insertBack(row, space.first(other) + l);
                    entry = value;
                    if (space.first(other) + l != row) continue;
                    // A node that nothing reaches has no energy, and says nothing; a vertex like that has no solution.
                    entry = value > 0.0 ? value * (1.0 + raised) : height == GradedSpace::most ? 1.0 : 0.0;
                }
                at += static_cast<std::size_t>(height) * width;
            }
        }
    }
    result.finalize();
    piece.reach(1.0);
    return result;
}

}  // namespace isograft

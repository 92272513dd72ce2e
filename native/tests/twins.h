// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "growth/patches.h"
#include "isograft/match.h"
#include "scale/setting.h"
#include "shapes.h"

namespace isograft {

/// A body without symmetry and the same turned, moved and renumbered, prepared for matching: the right map is known.
class Twins {
  public:
    explicit Twins(const shapes::Shape& source) : Twins(source, source) {}
    /// The target is made of `other`, which lies where the source does and may lack parts of it.
    Twins(const shapes::Shape& source, const shapes::Shape& other);

    [[nodiscard]] const Pair& pair() const { return prepared_.pair; }
    [[nodiscard]] const PreparedPair& prepared() const { return prepared_; }
    [[nodiscard]] const MatchOptions& options() const { return options_; }
    [[nodiscard]] PatchSettings settings() const;
    [[nodiscard]] double spacing() const { return pair().source.samples.spacing; }

    /// What turned the target.
    [[nodiscard]] const Eigen::Matrix3d& turn() const { return turn_; }
    /// Where a place on the source's mesh belongs on the target's.
    [[nodiscard]] Eigen::Vector3d truth(const Eigen::Vector3d& x) const;
    /// The target's nearest surface point to that of a source sample, and how the frames turn.
    [[nodiscard]] OrientedMatch true_match(int sample) const;
    /// The map that holds the given samples where they belong.
    [[nodiscard]] PartialMap true_map(const std::vector<int>& samples) const;
    [[nodiscard]] std::vector<int> all_samples() const;
    /// Distance of an image from where it belongs, in spacings.
    [[nodiscard]] double error(int sample, const Eigen::Vector3d& image) const;

    /// Whole twins of a blob, made once.
    static const Twins& of_a_blob();

  private:
    Eigen::Matrix3d turn_;
    Eigen::Vector3d shift_;
    MatchOptions options_;
    PreparedPair prepared_;
};

}  // namespace isograft

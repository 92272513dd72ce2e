// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

namespace isograft {

/// Sums over edges: of donor vectors times receiver vectors, and of squared lengths.
struct Moments {
    Eigen::Matrix3d product = Eigen::Matrix3d::Zero();
    double receiver = 0.0;
    double donor = 0.0;

    void add(const Moments& other, double weight = 1.0) {
        product += weight * other.product;
        receiver += weight * other.receiver;
        donor += weight * other.donor;
    }
    [[nodiscard]] bool usable() const { return receiver > 0.0 && donor > 0.0; }
};

}  // namespace isograft

// SPDX-License-Identifier: GPL-3.0-or-later
#include "transfer/neighbourhood.h"

namespace isograft {

Neighbourhood::Neighbourhood(const DonorView& donor) : donor_(donor), stamp_(donor.faces.rows(), 0) {}

const std::vector<int>& Neighbourhood::gather(const int* seeds, int count, const Eigen::Vector3d& centre,
                                              double radius) {
    ++run_;
    found_.clear();
    const auto add = [&](int f) {
        if (stamp_[f] == run_) return;
        stamp_[f] = run_;
        if ((donor_.point(f, donor_.closest(f, centre)) - centre).norm() <= radius) found_.push_back(f);
    };
    for (int i = 0; i < count; ++i) add(seeds[i]);
    const auto& next = donor_.graph.next;
    for (std::size_t at = 0; at < found_.size(); ++at) {
        const int f = found_[at];
        for (int h = 3 * f; h < 3 * f + 3; ++h) {
            for (int g = next[h]; g != h; g = next[g]) add(g / 3);
        }
    }
    return found_;
}

}  // namespace isograft

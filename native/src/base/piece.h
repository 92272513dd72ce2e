// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "isograft/monitor.h"

namespace isograft {

/// A piece of a call's progress that one task has to fill, on whatever thread it runs; the pieces of tasks that run
/// side by side add up.
class Piece {
  public:
    /// \param size share of the whole call, >= 0; without one it only checks. `monitor` must outlive it.
    /// Not explicit: who has no share to give passes its monitor.
    // NOLINTNEXTLINE(google-explicit-constructor)
    Piece(Monitor& monitor, double size = 0.0) : monitor_(&monitor), size_(size) {}

    void check() { monitor_->check(); }

    /// Do as check(), and `fraction` of this piece is done; what was done before stays done.
    void reach(double fraction) {
        if (fraction <= done_) {
            check();
            return;
        }
        const double more = (fraction - done_) * size_;
        done_ = fraction;
        monitor_->add(more);
    }

    /// What lies between what is done and `fraction`, to be filled by someone else: here it counts as done.
    [[nodiscard]] Piece until(double fraction) {
        const Piece part(*monitor_, fraction > done_ ? (fraction - done_) * size_ : 0.0);
        done_ = fraction > done_ ? fraction : done_;
        return part;
    }

    /// The same in `count` equal pieces, for tasks side by side.
    [[nodiscard]] std::vector<Piece> split(double fraction, std::size_t count) {
        Piece whole = until(fraction);
        whole.size_ /= static_cast<double>(std::max<std::size_t>(1, count));
        return std::vector<Piece>(count, whole);
    }

    [[nodiscard]] Monitor& monitor() const { return *monitor_; }

  private:
    Monitor* monitor_;
    double size_;
    double done_ = 0.0;
};

}  // namespace isograft

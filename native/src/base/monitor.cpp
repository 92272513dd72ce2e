// SPDX-License-Identifier: GPL-3.0-or-later
#include "isograft/monitor.h"

#include <algorithm>

#include "isograft/errors.h"

namespace isograft {

void Monitor::check() const {
    if (cancelled()) throw Cancelled();
}

void Monitor::report(const std::string& stage, double fraction) {
    check();
    // The comparison is false for NaN, which then counts as no progress.
    if (fraction > last_) last_ = std::min(fraction, 1.0);
    if (callback_ && !callback_(stage, last_)) cancel();
    check();
}

}  // namespace isograft

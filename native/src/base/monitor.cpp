// SPDX-License-Identifier: GPL-3.0-or-later
#include "isograft/monitor.h"

#include <algorithm>

#include "isograft/errors.h"

namespace isograft {

namespace {
constexpr std::chrono::milliseconds usual_silence{50};
}  // namespace

void Monitor::check() {
    if (cancelled()) throw Cancelled();
    if (!callback_ || std::this_thread::get_id() != reporter_.load(std::memory_order_relaxed)) return;
    if (std::chrono::steady_clock::now() - told_ >= usual_silence) tell();
}

void Monitor::report(const std::string& stage, double fraction) {
    if (cancelled()) throw Cancelled();
    reporter_.store(std::this_thread::get_id(), std::memory_order_relaxed);
    double last = fraction_.load(std::memory_order_relaxed);
    // The comparison is false for NaN, which then counts as no progress.
    while (fraction > last && !fraction_.compare_exchange_weak(last, fraction, std::memory_order_relaxed)) {
    }
    stage_ = stage;
    tell();
}

void Monitor::add(double part) {
    fraction_.fetch_add(part, std::memory_order_relaxed);
    check();
}

double Monitor::fraction() const noexcept { return std::min(1.0, fraction_.load(std::memory_order_relaxed)); }

void Monitor::tell() {
    if (callback_ && !callback_(stage_, fraction())) cancel();
    told_ = std::chrono::steady_clock::now();
    if (cancelled()) throw Cancelled();
}

}  // namespace isograft

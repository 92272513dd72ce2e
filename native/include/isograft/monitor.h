// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <functional>
#include <string>

namespace isograft {

/// Progress and cancellation of one call: the only handle between a running stage and its caller.
///
/// The stages poll `check()` often and from any thread; the callback runs only on the thread that called match(),
/// so that a binding may take its interpreter lock there and nowhere else.
class Monitor {
  public:
    /// Called with the stage's name and the fraction done in [0, 1], rising within the whole call and ending at 1.
    /// Returning false asks for cancellation.
    using Callback = std::function<bool(const std::string& stage, double fraction)>;

    Monitor() = default;
    explicit Monitor(Callback callback) : callback_(std::move(callback)) {}

    /// Ask the running call to stop; safe from any thread and from a signal handler.
    void cancel() noexcept { cancelled_.store(true, std::memory_order_relaxed); }

    [[nodiscard]] bool cancelled() const noexcept { return cancelled_.load(std::memory_order_relaxed); }

    /// \throw Cancelled if cancellation was asked for.
    void check() const;

    /// Report progress; on the calling thread only. Fractions below the last one are raised to it.
    /// \throw Cancelled if the callback returns false or cancellation was asked for.
    void report(const std::string& stage, double fraction);

  private:
    Callback callback_;
    std::atomic<bool> cancelled_{false};
    double last_ = 0.0;
};

}  // namespace isograft

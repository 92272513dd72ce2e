// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <string>
#include <thread>

namespace isograft {

/// Progress and cancellation of one call: the only handle between a running stage and its caller.
///
/// The stages poll `check()` often and from any thread; the callback runs only on the thread that called match(),
/// so that a binding may take its interpreter lock there and nowhere else.
class Monitor {
  public:
    /// Called with the stage's name and the fraction done in [0, 1], rising within the whole call and ending at 1;
    /// about twenty times a second, also while the fraction stays. Returning false asks for cancellation.
    using Callback = std::function<bool(const std::string& stage, double fraction)>;

    Monitor() = default;
    explicit Monitor(Callback callback) : callback_(std::move(callback)) {}

    /// Ask the running call to stop; safe from any thread and from a signal handler.
    void cancel() noexcept { cancelled_.store(true, std::memory_order_relaxed); }

    [[nodiscard]] bool cancelled() const noexcept { return cancelled_.load(std::memory_order_relaxed); }

    /// From any thread. On the one that reports, the callback is called if it was not lately.
    /// \throw Cancelled if cancellation was asked for.
    void check();

    /// Report progress and begin a stage, perhaps the one that is on; on the calling thread only. Fractions below the
    /// last one are raised to it.
    /// \throw Cancelled if the callback returns false or cancellation was asked for.
    void report(const std::string& stage, double fraction);

    /// A check, and `part` of the whole more is done.
    void add(double part);

    /// The fraction done. From any thread.
    [[nodiscard]] double fraction() const noexcept;

  private:
    void tell();

    Callback callback_;
    std::atomic<bool> cancelled_{false};
    std::atomic<double> fraction_{0.0};
    std::atomic<std::thread::id> reporter_{};
    // Of the reporting thread.
    std::string stage_;
    std::chrono::steady_clock::time_point told_{};
};

}  // namespace isograft

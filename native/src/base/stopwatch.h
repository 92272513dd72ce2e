// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>

namespace isograft {

/// Wall time since it was made or last asked.
class Stopwatch {
  public:
    double lap() {
        const auto now = std::chrono::steady_clock::now();
        const double seconds = std::chrono::duration<double>(now - start_).count();
        start_ = now;
        return seconds;
    }

  private:
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace isograft

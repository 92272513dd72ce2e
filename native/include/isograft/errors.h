// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stdexcept>
#include <string>

namespace isograft {

/// The input cannot be used. The text says what is wrong, where, how many there are, and what to do next.
class InvalidInput : public std::invalid_argument {
  public:
    using std::invalid_argument::invalid_argument;
};

/// The input is larger than the limits of this build (vertex indices are 32-bit) or than the memory allowed.
class ResourceLimit : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// The caller asked to stop through its Monitor. Nothing is left behind.
class Cancelled : public std::runtime_error {
  public:
    Cancelled() : std::runtime_error("cancelled by the caller") {}
};

}  // namespace isograft

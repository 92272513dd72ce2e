// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace isograft {

/// Rows of a long loop between two looks at the wish to stop: microseconds.
constexpr int rows_a_check = 1024;

}  // namespace isograft

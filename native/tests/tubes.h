// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "twins.h"

namespace isograft {

/// Twins of a tube whose cross-section is neither round nor symmetric. Unrolled it is a rectangle, so that a map which
/// turns it keeps every length, and only shape tells.
const Twins& tubes();
/// The same with 15 fine grooves along it: fine shape that nearly repeats.
const Twins& grooved_tubes();

/// The true map of tubes, turned by `way` spacings.
PartialMap turned(const Twins& tubes, double way);

/// Mean distance of the images from where they belong, in spacings.
double mean_error(const Twins& of, const PartialMap& map);

}  // namespace isograft

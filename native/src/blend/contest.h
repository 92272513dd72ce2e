// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "blend/completion.h"

namespace isograft {

/// Let other patches contest a finished map where it leaves a part of T empty, and, unless it is worth a lot, where
/// most patches put a part of S elsewhere. On a whole body an empty limb means that the part of S which belongs there
/// was put on another limb or doubled with it; two limbs that were exchanged leave nothing empty, but patches disagree.
/// Each claim (see Completion::claims() and dissent()) is carried out on a copy and extended like the map itself; the
/// map that is worth most by Completion::worth() stays, and is contested in turn.
///
/// Costs next to nothing where there is nothing to contest. Equal bit for bit for any number of threads.
/// \param worth Completion::worth() of it, which the caller has measured.
/// \return `completion`, whose map is finished, or a better one.
std::unique_ptr<Completion> contest(std::unique_ptr<Completion> completion, double worth, const Pair& pair,
                                    const PatchSettings& settings, Piece progress);

}  // namespace isograft

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "blend/completion.h"

namespace isograft {

/// Let other patches contest a finished map where it leaves a part of T empty: on a whole body an empty limb means that
/// the part of S which belongs there was put elsewhere, on another limb or doubled with it. Each claim (see
/// Completion::claims()) is carried out on a copy and extended like the map itself; the map that is worth most by
/// choice_score() stays, and its own empty parts are contested in turn.
///
/// Costs nothing where the map leaves no empty part. Equal bit for bit for any number of threads.
/// \return `completion`, whose map is finished, or a better one.
std::unique_ptr<Completion> contest(std::unique_ptr<Completion> completion, const Pair& pair,
                                    const PatchSettings& settings, Piece progress);

}  // namespace isograft

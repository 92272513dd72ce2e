// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "feature/pair.h"
#include "growth/partial_map.h"

namespace isograft {

/// Connected parts of T's samples near which no image lies, the largest first: a limb that no part of S came to.
///
/// \param least smallest part, as a share of T's area; smaller ones are left out.
/// \return indices of T's samples, rising.
std::vector<std::vector<int>> vacant_parts(const Pair& pair, const PartialMap& map, double least);

/// The marked samples, sorted into parts that level-0 edges join, the largest first.
/// \param least smallest part, as a share of the surface's area; smaller ones are left out. \return indices, rising.
std::vector<std::vector<int>> parts_by_area(const Samples& samples, std::vector<char> marked, double least);

/// Samples of S whose images lie among those of another part of S that is to be trusted more: of two parts on one
/// place, one is wrong. Parts are compared by their mean doubt, so that one wins whole.
/// \param doubts per sample of S, as Completion::doubts() has them. \return per sample 1 where it loses.
std::vector<char> doubled(const Pair& pair, const PartialMap& map, const std::vector<double>& doubts);

/// Sort maps into sets that can be true together: two maps cannot if they put most of the samples they share in
/// different places, or distant samples in one place. Each set begins with the heaviest map that is in none yet and
/// takes what goes with all its members, by falling weight.
/// \param radius images nearer than this are in one place. \return at most `count` sets of indices into `maps`.
std::vector<std::vector<std::size_t>> compatible_sets(const Samples& source, const std::vector<const PartialMap*>& maps,
                                                      const std::vector<double>& weights, double radius,
                                                      std::size_t count);

}  // namespace isograft

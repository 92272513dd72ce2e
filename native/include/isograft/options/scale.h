// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace isograft {

/// Where sigma, the target's units per unit of the source, comes from.
enum class ScaleMode {
    automatic,  ///< found from candidates, decided by consensus
    fixed,      ///< 1: both surfaces are in the same unit
    given,      ///< ScaleOptions::value
};

/// Options of the scale search.
struct ScaleOptions {
    ScaleMode mode = ScaleMode::automatic;
    /// sigma, if mode is `given`.
    double value = 1.0;
    /// Source samples whose descriptors vote.
    int votes = 80;
    /// Matches that are probed per candidate where the votes do not settle it.
    int probes = 120;

    template <class Visitor>
    void visit(Visitor&& visitor) {
        visitor("value", value);
        visitor("votes", votes);
        visitor("probes", probes);
    }

    /// \throw InvalidInput naming the first field that is out of range.
    void validate() const;
};

}  // namespace isograft

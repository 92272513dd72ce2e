// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace isograft {

/// Options of the oriented matches and of the probes that rank them.
struct SeedOptions {
    /// Oriented matches kept per source sample.
    int candidates = 3;
    /// Matches that are probed, the best first.
    int probes = 250;
    /// Samples a probe may map.
    int probe_size = 40;
    /// A sample that sees less of its window than this gives no seed.
    double min_visible = 0.4;
    /// Candidates of one sample are at least this many sample spacings apart.
    double separation = 2.5;
    /// Start from the landmarks alone.
    bool landmarks_only = false;

    template <class Visitor>
    void visit(Visitor&& visitor) {
        visitor("candidates", candidates);
        visitor("probes", probes);
        visitor("probe_size", probe_size);
        visitor("min_visible", min_visible);
        visitor("separation", separation);
        visitor("landmarks_only", landmarks_only);
    }

    /// \throw InvalidInput naming the first field that is out of range.
    void validate() const;
};

}  // namespace isograft

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace isograft {

/// Options of the samples and their hierarchy. Lengths are in units of the sample spacing r0.
struct HierarchyOptions {
    /// Samples on a surface of one unit area; r0 follows from it. More samples: finer maps, longer runs.
    int samples = 1000;
    /// Fewest samples on either surface; a small part gets a smaller spacing rather than fewer.
    int min_samples = 350;
    /// Levels; the spacing doubles from one to the next.
    int levels = 4;
    /// Samples nearer than this are joined at level 0.
    double base_reach = 2.3;
    /// Samples nearer than this times the level's spacing are joined at the levels above.
    double level_reach = 2.0;
    /// An edge whose window length and traced length differ by more than this share is dropped.
    double reshoot_tolerance = 0.08;
    /// Finer meshes are coarsened to edges of this length before windows are run on them; 0 never does.
    double coarse_edge = 0.48;

    template <class Visitor>
    void visit(Visitor&& visitor) {
        visitor("samples", samples);
        visitor("min_samples", min_samples);
        visitor("levels", levels);
        visitor("base_reach", base_reach);
        visitor("level_reach", level_reach);
        visitor("reshoot_tolerance", reshoot_tolerance);
        visitor("coarse_edge", coarse_edge);
    }

    /// \throw InvalidInput naming the first field that is out of range.
    void validate() const;
};

}  // namespace isograft

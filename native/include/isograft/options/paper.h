// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace isograft {

/// Options of preset `paper`: the steps and parameters of the paper, sections 4.1 to 4.4 and 5.1, as printed there.
///
/// Lengths are in e0, the mean edge length of the source, or in R, 5 % of the source's geodesic diameter. No other
/// stage's options are used, but those of the scale search.
struct PaperOptions {
    /// Run the paper's steps instead of ours.
    bool steps = false;
    /// Level 0 has about so many vertices at most; a finer mesh is decimated, with a warning.
    int vertices = 10000;
    /// Levels of the hierarchy, the vertices included.
    int levels = 5;
    /// Radii of the first and the last isocontour in R: 0.9 and 1.7 for clean surfaces, 1.5 and 3.4 for noisy ones.
    double radius_min = 0.9;
    double radius_max = 1.7;
    /// Isocontours in between, those two included.
    int contours = 10;
    /// K: target features kept per source feature.
    int candidates = 10;
    /// w_D of eq. 7.
    double descriptor_weight = 400.0;
    /// w_C of eq. 8 times e0^2.
    double distance_weight = 0.125;
    /// A feature match joins a cluster while its dissimilarity is below this.
    double cluster_limit = 11.5;
    /// Oriented matches that are tried.
    int matches = 200;
    /// nu in e0.
    double stretch_limit = 0.5;
    /// How far N1, from which vertices are predicted, reaches in e1; the paper does not say. Farther away the stretch
    /// that limbs really have is beyond nu: with 1.5 the true map of two SCAPE scans itself breaks eq. 5 at a fifth to
    /// a half of the vertices, with 1 at a tenth to a quarter. More is stricter where surfaces do not stretch at all.
    double near = 1.0;
    /// Steps that the least squares try at every doubling of a map's area at most; they end before with one that gains,
    /// but less than a thousandth. After a few only, limbs that were grown with a drift stay turned or shifted.
    int iterations = 30;
    /// Nearest maps that each map is joined with in the graph of the linkage (Zhang et al. 2012). The paper does not
    /// say how many; with many more, wrong maps tie everything together, with fewer the right ones fall apart.
    int neighbours = 10;
    /// q: clusters are joined while the largest affinity is above this, and above 0.05. Lower joins maps that agree
    /// less; the paper uses 0 (samba), 1 (raw scans) and 1.9 (SCAPE).
    double threshold = 1.0;
    /// One over the decay of a map's say in the merge, in e1 = 2 e0.
    double decay = 5.0;

    template <class Visitor>
    void visit(Visitor&& visitor) {
        visitor("steps", steps);
        visitor("vertices", vertices);
        visitor("levels", levels);
        visitor("radius_min", radius_min);
        visitor("radius_max", radius_max);
        visitor("contours", contours);
        visitor("candidates", candidates);
        visitor("descriptor_weight", descriptor_weight);
        visitor("distance_weight", distance_weight);
        visitor("cluster_limit", cluster_limit);
        visitor("matches", matches);
        visitor("stretch_limit", stretch_limit);
        visitor("near", near);
        visitor("iterations", iterations);
        visitor("neighbours", neighbours);
        visitor("threshold", threshold);
        visitor("decay", decay);
    }

    /// \throw InvalidInput naming the first field that is out of range.
    void validate() const;
};

}  // namespace isograft

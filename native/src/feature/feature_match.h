// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include <Eigen/Core>

#include "geodesic/surface_point.h"
#include "isograft/monitor.h"

namespace isograft {

/// Geodesics between the features of one surface.
struct FeatureGeodesics {
    /// Distance from row to column, infinite beyond the reach asked for.
    Eigen::MatrixXd distance;
    /// Angle at the row's point towards the column's, in the frame of its triangle.
    Eigen::MatrixXd angle;
};

/// O(#points windows of `reach`).
FeatureGeodesics feature_geodesics(const TriangleMesh& mesh, const std::vector<SurfacePoint>& points, double reach,
                                   int threads, Monitor& monitor, double from, double to);

/// A source feature and a target feature, by their numbers.
struct FeatureMatch {
    int source = -1;
    int target = -1;
    /// d_init of eq. 7.
    double dissimilarity = 0.0;
    /// The least dissimilarity (eq. 8) to a cluster it is part of; infinite if it is part of none. Lower is surer.
    double priority = 0.0;
};

/// The features of a surface: a row of each is one feature.
struct FeatureSet {
    Eigen::MatrixXd descriptor;
    Eigen::VectorXd distinctiveness;
};

/// For every source feature its `candidates` nearest target features in descriptor space, with eq. 7:
/// -log F_S(s) + weight |D_S(s) - D_T(t)|^2. By rising source feature, then rising dissimilarity.
std::vector<FeatureMatch> candidate_matches(const FeatureSet& source, const FeatureSet& target, int candidates,
                                            double weight);

/// Parameters of cluster_matches().
struct ClusterOptions {
    /// w_C of eq. 8, in one over a squared length.
    double weight = 1.0;
    /// A match joins while its dissimilarity is below this.
    double limit = 11.5;
    /// Source features nearer than this are neighbours.
    double reach = 1.0;
};

/// Set the matches' priorities by building overlapping clusters of consistent matches (section 4.2, eq. 8).
///
/// Each cluster starts from the match with the next lowest d_init and takes in, one after the other, the match of a
/// neighbouring feature with the lowest dissimilarity; no feature of S twice. It ends once all clusters together have
/// more members than there are matches. \return the members of every cluster, as indices into `matches`.
std::vector<std::vector<int>> cluster_matches(std::vector<FeatureMatch>& matches, const FeatureGeodesics& source,
                                              const FeatureGeodesics& target, const ClusterOptions& options,
                                              Monitor& monitor);

}  // namespace isograft

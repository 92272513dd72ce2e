// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include <Eigen/Core>

namespace isograft {

/// An affinity below this is none. Where clusters are large, chance edges leave a little of it between any two, and
/// with q = 0 as printed all maps come to be joined, depending on rounding: of 199 maps of samba (2,500 vertices) 139,
/// the 29 that were right with 110 others, in steps of 0.0012 and less. At 4,000 vertices a bound of 0.003 gave in one
/// position a cluster of 64 with 33 right ones, this one 32 with 24.
constexpr double least_affinity = 0.05;

/// Options of graph_degree_linkage().
struct LinkageOptions {
    /// Each item is joined with so many nearest others.
    int neighbours = 10;
    /// q: clusters are joined while the largest affinity of two is above it and `least_affinity`.
    double threshold = 1.0;
};

/// Clusters of items, the one of the highest intra-cluster affinity first.
struct Clusters {
    /// Per cluster its items, ascending; items without a neighbour are clusters of one.
    std::vector<std::vector<int>> members;
    /// Per cluster the mean over its members of in-degree times out-degree within it: how much a member is tied to the
    /// others. Over the squared size, as affinity() has it for two clusters, it would fall with one over the size once
    /// that is beyond the number of neighbours, and the winner would be a small cluster of about so many items.
    std::vector<double> affinity;
};

/// Weights of the directed k-nearest-neighbour graph: exp(-d^2 / sigma^2) from row to column where the column is among
/// the row's nearest, sigma^2 the mean squared distance over all such pairs; 0 elsewhere and where d is infinite.
/// \param distance square, symmetric, >= 0; infinite where two items cannot be compared.
Eigen::MatrixXd neighbour_weights(const Eigen::MatrixXd& distance, int neighbours);

/// Affinity of two clusters: 1' W_ab W_ba 1 / |a|^2 + 1' W_ba W_ab 1 / |b|^2 (Zhang et al. 2012, eq. 7); two lone
/// items that point at each other with weight 1 have affinity 2.
double affinity(const Eigen::MatrixXd& weight, const std::vector<int>& a, const std::vector<int>& b);

/// Agglomerative clustering by graph degree linkage (Zhang, Wang, Zhao, Tang 2012; paper section 4.4).
///
/// Starts from single items and joins the two clusters of the largest affinity, ties by the lowest indices, until none
/// is above the threshold and `least_affinity`. O(items^2) per join over the clusters' blocks.
Clusters graph_degree_linkage(const Eigen::MatrixXd& distance, const LinkageOptions& options);

/// The clusters by affinity times area, the largest first; where that is equal the larger area, then the lower index.
///
/// Images of a small region are never far apart, so by the affinity alone maps of one part of a surface would win over
/// maps of the whole. The paper takes the affinity and says that its cluster most often covers the largest area.
/// \param area per cluster what its maps cover together, >= 0.
std::vector<int> by_affinity_and_area(const Clusters& clusters, const std::vector<double>& area);

}  // namespace isograft

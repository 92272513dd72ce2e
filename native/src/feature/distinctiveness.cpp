// SPDX-License-Identifier: GPL-3.0-or-later
#include "feature/distinctiveness.h"

#include <algorithm>
#include <numeric>

namespace isograft {

Eigen::VectorXd distinctiveness(const Eigen::MatrixXd& descriptors) {
    const Eigen::Index n = descriptors.rows();
    Eigen::VectorXd result = Eigen::VectorXd::Zero(n);
    std::vector<int> order(n);
    for (Eigen::Index k = 0; k < descriptors.cols(); ++k) {
        const auto value = descriptors.col(k);
        std::iota(order.begin(), order.end(), 0);
        std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return value[a] < value[b]; });
        const double total = value.sum();
        double below = 0.0;
        for (Eigen::Index rank = 0; rank < n; ++rank) {
            const double x = value[order[rank]];
            const auto lower = static_cast<double>(rank);
            const auto higher = static_cast<double>(n - rank - 1);
            result[order[rank]] += lower * x - below + (total - below - x) - higher * x;
            below += x;
        }
    }
    return result.cwiseMax(0.0);
}

std::vector<int> local_maxima(const TriangleMesh& mesh, const Eigen::VectorXd& values) {
    std::vector<int> result;
    for (int v = 0; v < mesh.vertex_count(); ++v) {
        bool highest = true;
        for (int i = mesh.vertex_face_begin[v]; highest && i < mesh.vertex_face_begin[v + 1]; ++i) {
            for (const int w : mesh.face[mesh.vertex_face[i]]) {
                if (w != v && (values[w] > values[v] || (values[w] == values[v] && w < v))) highest = false;
            }
        }
        if (highest) result.push_back(v);
    }
    return result;
}

}  // namespace isograft

// SPDX-License-Identifier: GPL-3.0-or-later
#include "transfer/sparse.h"

#include <algorithm>
#include <vector>

#include "transfer/pace.h"

namespace isograft {

RowMatrix multiply(const RowMatrix& a, const RowMatrix& b, Monitor& monitor) {
    std::vector<double> sum(b.cols(), 0.0);
    std::vector<Eigen::Index> seen_in(b.cols(), -1);
    std::vector<int> columns;
    std::vector<int> starts{0}, inner;
    std::vector<double> values;
    starts.reserve(a.rows() + 1);
    inner.reserve(a.nonZeros());
    values.reserve(a.nonZeros());
    for (Eigen::Index row = 0; row < a.rows(); ++row) {
        if (row % rows_a_check == 0) monitor.check();
        columns.clear();
        for (RowMatrix::InnerIterator left(a, row); left; ++left) {
            for (RowMatrix::InnerIterator right(b, left.col()); right; ++right) {
                const auto column = static_cast<int>(right.col());
                if (seen_in[column] != row) {
                    seen_in[column] = row;
                    sum[column] = 0.0;
                    columns.push_back(column);
                }
                sum[column] += left.value() * right.value();
            }
        }
        std::sort(columns.begin(), columns.end());
        for (const int column : columns) {
            inner.push_back(column);
            values.push_back(sum[column]);
        }
        starts.push_back(static_cast<int>(inner.size()));
    }
    return Eigen::Map<const RowMatrix>(a.rows(), b.cols(), static_cast<Eigen::Index>(inner.size()), starts.data(),
                                       inner.data(), values.data());
}

}  // namespace isograft

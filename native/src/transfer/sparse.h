// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/SparseCore>

#include "isograft/monitor.h"

namespace isograft {

/// Rows are what the solvers walk along. All of their matrices are square and symmetric, or lead from one level to
/// another.
using RowMatrix = Eigen::SparseMatrix<double, Eigen::RowMajor>;

/// a b, row by row, so that it can be stopped; columns ascend in every row. O(products of entries).
/// \throw Cancelled
RowMatrix multiply(const RowMatrix& a, const RowMatrix& b, Monitor& monitor);

}  // namespace isograft

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "isograft/errors.h"
#include "isograft/monitor.h"
#include "isograft/surface.h"

namespace py = pybind11;

namespace isograft::bindings {

// One function per public header; each adds that header's names to the module.
void bind_errors(py::module_& m);
void bind_surface(py::module_& m);
void bind_correspondence(py::module_& m);
void bind_match(py::module_& m);
void bind_geodesic(py::module_& m);

/// Run `work` on a thread of its own while the calling thread serves Python.
///
/// The calling thread alone touches Python: with the interpreter's lock released it waits for the work, and
/// at every report, at the latest every 50 ms, takes the lock to look for signals (Ctrl-C) and to call
/// `progress(stage, fraction)`. The last report is repeated at least every 50 ms, so that a caller can cancel
/// or draw while one stage is long.
/// \param progress None or a callable; returning False cancels.
/// \throw Cancelled if the callable returned False; whatever the callable or a signal handler raised, once the
/// work has stopped; whatever `work` throws.
void run_with_progress(const py::object& progress, const std::function<void(Monitor&)>& work);

using DoubleArray = py::array_t<double, py::array::c_style | py::array::forcecast>;
using IntArray = py::array_t<int, py::array::c_style>;

/// Rows of a (n, 3) array. \throw InvalidInput naming `name` and the shape found.
Points to_points(const DoubleArray& array, const std::string& name);
Triangles to_triangles(const IntArray& array, const std::string& name);

/// Contiguous copies in row order.
template <class Derived>
py::array_t<typename Derived::Scalar> to_numpy(const Eigen::MatrixBase<Derived>& matrix) {
    using Scalar = typename Derived::Scalar;
    if constexpr (Derived::ColsAtCompileTime == 1) {
        py::array_t<Scalar> array(static_cast<py::ssize_t>(matrix.rows()));
        Eigen::Map<Eigen::Matrix<Scalar, Eigen::Dynamic, 1>>(array.mutable_data(), matrix.rows()) = matrix;
        return array;
    } else {
        py::array_t<Scalar> array({static_cast<py::ssize_t>(matrix.rows()), static_cast<py::ssize_t>(matrix.cols())});
        Eigen::Map<Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
            array.mutable_data(), matrix.rows(), matrix.cols()) = matrix;
        return array;
    }
}

}  // namespace isograft::bindings

/// Likewise of transfer.h and the headers of single transfers.
void bind_transfer(py::module_& m);
void bind_invert(py::module_& m);
void bind_frames(py::module_& m);
void bind_bake(py::module_& m);
void bind_paint(py::module_& m);
void bind_fill(py::module_& m);
void bind_locate(py::module_& m);

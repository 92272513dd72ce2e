// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <complex>

namespace isograft {

using Complex = std::complex<double>;

inline double cross(Complex a, Complex b) { return a.real() * b.imag() - a.imag() * b.real(); }
inline double dot(Complex a, Complex b) { return a.real() * b.real() + a.imag() * b.imag(); }

/// a / |a|, or 1 for a vector without length.
inline Complex unit(Complex a) {
    const double n = std::abs(a);
    return n > 1e-300 ? a / n : Complex(1.0, 0.0);
}

/// The angle in (-pi, pi] that differs from `a` by full turns.
inline double wrap_angle(double a) { return a - 2.0 * M_PI * std::ceil((a - M_PI) / (2.0 * M_PI)); }

}  // namespace isograft

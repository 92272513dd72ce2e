// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <complex>

namespace isograft {

using Complex = std::complex<double>;

inline double cross(Complex a, Complex b) { return a.real() * b.imag() - a.imag() * b.real(); }
inline double dot(Complex a, Complex b) { return a.real() * b.real() + a.imag() * b.imag(); }

/// |a| without std::abs's care for overflow, which costs three times as much: lengths here are far from the ends of the
/// range (the gate sees to that).
inline double modulus(Complex a) { return std::sqrt(dot(a, a)); }

/// a / |a|, or 1 for a vector without length.
inline Complex unit(Complex a) {
    const double n = modulus(a);
    return n > 1e-150 ? a * (1.0 / n) : Complex(1.0, 0.0);
}

/// a / |a| where |a| is 1 within rounding, as of products of unit numbers: one step of Newton's method takes that off.
inline Complex unit_again(Complex a) { return a * (1.5 - 0.5 * dot(a, a)); }

/// The angle in (-pi, pi] that differs from `a` by full turns.
inline double wrap_angle(double a) { return a - 2.0 * M_PI * std::ceil((a - M_PI) / (2.0 * M_PI)); }

}  // namespace isograft

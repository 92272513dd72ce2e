// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace isograft {

/// Options of the surfaces before anything is measured on them.
struct SurfaceOptions {
    /// Smooth meshes by robust implicit moving least squares: radius of its weights in local mean edge lengths, 0 =
    /// off. Takes away noise of a fraction of an edge, and what is finer than the radius with it. Clouds are always
    /// smoothed.
    double denoise = 0.0;
    /// Close holes of meshes while matching, where nothing is matched from or to: the longest rim in roots of the area
    /// of its part, 0 = none. Stumps and the outer rims of sheets stay open.
    double close_holes = 0.5;

    template <class Visitor>
    void visit(Visitor&& visitor) {
        visitor("denoise", denoise);
        visitor("close_holes", close_holes);
    }

    /// \throw InvalidInput naming the first field that is out of range.
    void validate() const;
};

}  // namespace isograft

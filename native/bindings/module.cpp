// SPDX-License-Identifier: GPL-3.0-or-later
#include "bindings.h"

PYBIND11_MODULE(_native, m) {
    m.doc() = "The compiled part of isograft. Use the package's own names: they check what is passed here.";
    isograft::bindings::bind_errors(m);
    isograft::bindings::bind_surface(m);
    isograft::bindings::bind_correspondence(m);
    isograft::bindings::bind_match(m);
    isograft::bindings::bind_geodesic(m);
    bind_transfer(m);
    bind_invert(m);
    bind_frames(m);
    bind_bake(m);
    bind_paint(m);
    bind_fill(m);
    bind_locate(m);
}

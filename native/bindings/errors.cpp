// SPDX-License-Identifier: GPL-3.0-or-later
#include "isograft/errors.h"

#include "bindings.h"

namespace isograft::bindings {

void bind_errors(py::module_& m) {
    // Named as part of the package, where users catch them and where pickle looks for them.
    py::register_exception<InvalidInput>(m, "InvalidInput", PyExc_ValueError).attr("__module__") = "isograft";
    py::register_exception<ResourceLimit>(m, "ResourceLimit", PyExc_MemoryError).attr("__module__") = "isograft";
    py::register_exception<Cancelled>(m, "Cancelled", PyExc_Exception).attr("__module__") = "isograft";
    m.attr("InvalidInput").attr("__doc__") =
        "The input cannot be used; the text says what is wrong, where, and what to do next.";
    m.attr("ResourceLimit").attr("__doc__") =
        "The input is larger than the limits of this build or the memory allowed.";
    m.attr("Cancelled").attr("__doc__") = "The caller asked to stop. Nothing is left behind.";
}

}  // namespace isograft::bindings

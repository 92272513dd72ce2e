# SPDX-License-Identifier: GPL-3.0-or-later
# The Python extension module isograft._native. It exports its init function only and needs no shared library beyond
# the system's C library: see tests/test_native_module.py.
file(GLOB binding_sources CONFIGURE_DEPENDS "${CMAKE_SOURCE_DIR}/native/bindings/*.cpp")
if(NOT binding_sources)
    message(WARNING "native/bindings holds no source: building without the module.")
    return()
endif()
pybind11_add_module(_native MODULE NO_EXTRAS ${binding_sources})
target_link_libraries(_native PRIVATE isograft_core isograft_flags)
# Without --gc-sections unused parts of the static C++ library ask for symbols newer than the wheel's platform tag.
target_link_options(_native PRIVATE
    -Wl,--exclude-libs,ALL -Wl,-Bsymbolic -Wl,--gc-sections
    -Wl,--version-script=${CMAKE_SOURCE_DIR}/cmake/module.map
    -static-libstdc++ -static-libgcc $<$<NOT:$<CONFIG:Debug>>:-Wl,-s>)
install(TARGETS _native LIBRARY DESTINATION isograft COMPONENT python)

# SPDX-License-Identifier: GPL-3.0-or-later
# Finds what the library is built on, and says which command installs what is missing.
find_package(Threads REQUIRED)
find_package(Eigen3 3.4 QUIET NO_MODULE)
find_package(nanoflann QUIET)
if(NOT Eigen3_FOUND OR NOT nanoflann_FOUND)
    message(FATAL_ERROR "Eigen 3.4 or nanoflann was not found. scripts/setup installs both.")
endif()

if(ISOGRAFT_MODULE)
    if(NOT DEFINED Python_EXECUTABLE AND EXISTS "${CMAKE_SOURCE_DIR}/.venv/bin/python")
        set(Python_EXECUTABLE "${CMAKE_SOURCE_DIR}/.venv/bin/python")
    endif()
    find_package(Python 3.11 REQUIRED COMPONENTS Interpreter Development.Module)
    # Under scikit-build-core pybind11 is already on the prefix path; elsewhere its own package says where it is.
    if(NOT SKBUILD)
        execute_process(COMMAND "${Python_EXECUTABLE}" -m pybind11 --cmakedir
            OUTPUT_VARIABLE pybind11_cmake_dir OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
        if(pybind11_cmake_dir)
            set(pybind11_DIR "${pybind11_cmake_dir}" CACHE PATH "Folder of pybind11Config.cmake" FORCE)
        endif()
    endif()
    set(PYBIND11_FINDPYTHON ON)
    find_package(pybind11 2.13 QUIET CONFIG)
    if(NOT pybind11_FOUND)
        message(FATAL_ERROR "pybind11 >= 2.13 is not installed for ${Python_EXECUTABLE}. "
            "Run scripts/setup, or pass -DISOGRAFT_MODULE=OFF to build without the module.")
    endif()
endif()

if(ISOGRAFT_TESTS)
    find_package(GTest REQUIRED)
    # What the least squares are held against; the library itself does without.
    find_package(Ceres 2.1 REQUIRED)
endif()
if(ISOGRAFT_BENCH)
    find_package(benchmark REQUIRED)
endif()

# SPDX-License-Identifier: GPL-3.0-or-later
# The interface target isograft_flags: what every translation unit of this project is compiled with.
#
# No -march=native and no -ffast-math, and contraction off: the same input gives the same bits on every x86-64 machine.
# No errno from sqrt and no NaN rescue in complex products: both change no bit of a finite result, and both cost calls.
# Hidden visibility: newer Blenders load Eigen users of their own, and ours must not be mistaken for theirs.
add_library(isograft_flags INTERFACE)
target_compile_options(isograft_flags INTERFACE
    -Wall -Wextra -ffp-contract=off -fno-math-errno -fcx-limited-range -fvisibility=hidden -fvisibility-inlines-hidden)

if(ISOGRAFT_SANITIZE)
    target_compile_options(isograft_flags INTERFACE
        -fsanitize=${ISOGRAFT_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer -g1)
    target_link_options(isograft_flags INTERFACE -fsanitize=${ISOGRAFT_SANITIZE})
    # Under a sanitizer Eigen aligns by hand, but the Ceres of a test was built without one: what the one allocates the
    # other may free. Every malloc here is aligned enough for both.
    target_compile_definitions(isograft_flags INTERFACE EIGEN_MALLOC_ALREADY_ALIGNED=1)
endif()

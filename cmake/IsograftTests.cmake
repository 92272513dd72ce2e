# SPDX-License-Identifier: GPL-3.0-or-later
# The executables isograft_tests (native/tests/**/*_test.cpp) and isograft_bench (native/bench/**/*.cpp). Both see the
# stages' own headers in native/src; the other sources of native/tests are shapes and checks that they share.
file(GLOB_RECURSE test_sources CONFIGURE_DEPENDS "${CMAKE_SOURCE_DIR}/native/tests/*.cpp")
set(support_sources ${test_sources})
list(FILTER test_sources INCLUDE REGEX "_test\\.cpp$")
list(FILTER support_sources EXCLUDE REGEX "_test\\.cpp$")
if(ISOGRAFT_TESTS_WITH)
    foreach(source IN LISTS test_sources)
        file(STRINGS "${source}" hits REGEX "${ISOGRAFT_TESTS_WITH}" LIMIT_COUNT 1)
        if(NOT hits)
            list(REMOVE_ITEM test_sources "${source}")
        endif()
    endforeach()
endif()

add_library(isograft_testing INTERFACE)
target_include_directories(isograft_testing INTERFACE native/src native/tests)
target_link_libraries(isograft_testing INTERFACE
    isograft_core isograft_flags Ceres::ceres nanoflann::nanoflann)
if(support_sources)
    add_library(isograft_shapes STATIC ${support_sources})
    target_link_libraries(isograft_shapes PRIVATE isograft_testing $<$<BOOL:${ISOGRAFT_TESTS}>:GTest::gtest>)
    target_link_libraries(isograft_testing INTERFACE $<LINK_ONLY:isograft_shapes>)
endif()

if(ISOGRAFT_TESTS AND test_sources)
    enable_testing()
    add_executable(isograft_tests ${test_sources})
    target_link_libraries(isograft_tests PRIVATE isograft_testing GTest::gmock GTest::gtest_main)
    add_test(NAME isograft_tests COMMAND isograft_tests)
endif()

file(GLOB_RECURSE bench_sources CONFIGURE_DEPENDS "${CMAKE_SOURCE_DIR}/native/bench/*.cpp")
if(ISOGRAFT_BENCH AND bench_sources)
    add_executable(isograft_bench ${bench_sources})
    target_link_libraries(isograft_bench PRIVATE isograft_testing benchmark::benchmark_main)
endif()

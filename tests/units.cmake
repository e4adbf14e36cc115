# The tests that are programs of their own: one a layer, and the corpora of the fuzzers.
find_package(GTest REQUIRED)
include(GoogleTest)
find_library(rapidcheck_library rapidcheck REQUIRED)

# The path of the sources stands in one object, so that a compiler cache serves every checkout.
add_library(servoctl_source_dir STATIC source_dir.cpp)
target_include_directories(servoctl_source_dir PRIVATE ${CMAKE_SOURCE_DIR})
target_compile_definitions(servoctl_source_dir PRIVATE SERVOCTL_SOURCE_DIR="${CMAKE_SOURCE_DIR}")

add_library(servoctl_tests_main STATIC main.cpp)
target_link_libraries(servoctl_tests_main PUBLIC GTest::gtest)

set(layers_by_length commands session od sim motion cabinet cli)

# tests/ mirrors src/: one program a layer.
function(servoctl_tests layer)
  file(GLOB sources CONFIGURE_DEPENDS ${layer}/*_test.cpp ${layer}/*_support.cpp)
  if(NOT sources)
    return()
  endif()
  add_executable(${layer}_tests ${sources})
  target_link_libraries(${layer}_tests PRIVATE ${ARGN} servoctl_options fmt::fmt servoctl_tests_main ${rapidcheck_library})
  target_include_directories(${layer}_tests PRIVATE ${CMAKE_SOURCE_DIR})
  target_link_libraries(${layer}_tests PRIVATE servoctl_source_dir servoctl_fixed_version)
  # What is tested has both sanitizers; of the tests themselves addresses are checked, which is a third quicker to compile.
  if(CMAKE_CXX_FLAGS MATCHES "fsanitize")
    target_compile_options(${layer}_tests PRIVATE -fno-sanitize=undefined)
  endif()
  servoctl_unity(${layer}_tests)
  if(SERVOCTL_UNITY)
    math(EXPR batch "2 * ${SERVOCTL_UNITY}")  # Half of what they cost is reading headers.
    set_target_properties(${layer}_tests PROPERTIES UNITY_BUILD_BATCH_SIZE ${batch})
  endif()
  if(SERVOCTL_PCH AND layer STREQUAL "base")
    target_precompile_headers(base_tests PRIVATE <algorithm> <chrono> <filesystem> <functional> <map> <memory> <optional> <span>
                              <string> <variant> <vector> <fmt/format.h> <gtest/gtest.h> <tl/expected.hpp>)
  elseif(SERVOCTL_PCH)
    target_precompile_headers(${layer}_tests REUSE_FROM base_tests)
  endif()
  if(NOT SERVOCTL_TEST_SHARDS)
    gtest_discover_tests(${layer}_tests DISCOVERY_TIMEOUT 60)
    return()
  endif()
  # A process a shard instead of one a test: the sanitizers take their time to start. Where a block was allocated they tell by two calls;
  # thirty were a tenth of the time.
  math(EXPR last "${SERVOCTL_TEST_SHARDS} - 1")
  foreach(shard RANGE ${last})
    add_test(NAME Units.${layer}.${shard} COMMAND ${layer}_tests --gtest_brief=1)
    # Those of the later layers take the longest: they begin.
    list(FIND layers_by_length ${layer} place)
    math(EXPR cost "${place} + 1")
    set_tests_properties(Units.${layer}.${shard} PROPERTIES TIMEOUT 900 COST ${cost}
                         ENVIRONMENT "GTEST_TOTAL_SHARDS=${SERVOCTL_TEST_SHARDS};GTEST_SHARD_INDEX=${shard};ASAN_OPTIONS=malloc_context_size=2")
  endforeach()
endfunction()

servoctl_tests(base servoctl_base)
servoctl_tests(can servoctl_can)
servoctl_tests(canopen servoctl_canopen)
servoctl_tests(ethercat servoctl_ethercat)
servoctl_tests(ethernet servoctl_ethernet)
servoctl_tests(modbus servoctl_modbus)
servoctl_tests(gateway servoctl_gateway)
servoctl_tests(od servoctl_od)
servoctl_tests(drive servoctl_drive)
servoctl_tests(report servoctl_report)
servoctl_tests(sim servoctl_sim)
servoctl_tests(session servoctl_session)
servoctl_tests(show servoctl_show)
servoctl_tests(motion servoctl_motion)
servoctl_tests(settings servoctl_settings)
servoctl_tests(traffic servoctl_traffic)
servoctl_tests(cabinet servoctl_cabinet)
servoctl_tests(commands servoctl_commands)
servoctl_tests(cli servoctl_cli)

add_subdirectory(fuzz)

# SPDX-License-Identifier: Apache-2.0
# One static library per second-level folder, explicit sources, one test binary per tested folder.

function(limn_warnings target)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Wimplicit-fallthrough)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # gcc 12 sees overlapping copies in std::string's own code (GCC bug 105651).
    target_compile_options(${target} PRIVATE -Wno-restrict)
  endif()
  if(LIMN_WERROR)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
endfunction()

# limn_library(NAME [HEADERS h...] [SOURCES cpp...] [PUBLIC lib...] [PRIVATE lib...])
# Makes limn_NAME (alias limn::NAME). Include paths are repository paths. Without sources: header-only.
function(limn_library name)
  cmake_parse_arguments(ARG "" "" "HEADERS;SOURCES;PUBLIC;PRIVATE" ${ARGN})
  if(ARG_SOURCES)
    add_library(limn_${name} STATIC ${ARG_SOURCES})
    set(scope PUBLIC)
    limn_warnings(limn_${name})
    target_link_libraries(limn_${name} PRIVATE ${ARG_PRIVATE})
  else()
    add_library(limn_${name} INTERFACE)
    set(scope INTERFACE)
  endif()
  target_include_directories(limn_${name} ${scope} "${PROJECT_SOURCE_DIR}")
  target_link_libraries(limn_${name} ${scope} ${ARG_PUBLIC})
  if(ARG_HEADERS)
    target_sources(limn_${name} ${scope} FILE_SET HEADERS BASE_DIRS "${PROJECT_SOURCE_DIR}" FILES ${ARG_HEADERS})
  endif()
  add_library(limn::${name} ALIAS limn_${name})
endfunction()

# limn_program(NAME SOURCES cpp... LINK lib...): an executable build/PRESET/bin/NAME.
function(limn_program name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  limn_warnings(${name})
  target_link_libraries(${name} PRIVATE ${ARG_LINK})
  target_compile_definitions(${name} PRIVATE LIMN_VERSION="${PROJECT_VERSION}")
endfunction()

# Everything that the inner loop (tests/run.sh --quick) runs.
add_custom_target(limn_quick)

# limn_test(NAME LABEL label SOURCES cpp... LINK lib...): a GoogleTest binary whose cases are CTest tests.
function(limn_test name)
  cmake_parse_arguments(ARG "" "LABEL" "SOURCES;LINK" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  limn_warnings(${name})
  target_link_libraries(${name} PRIVATE ${ARG_LINK} GTest::gtest_main)
  if(ARG_LABEL MATCHES "^(unit|conformance)$")
    add_dependencies(limn_quick ${name})
  endif()
  gtest_discover_tests(${name} DISCOVERY_MODE PRE_TEST PROPERTIES LABELS ${ARG_LABEL})
endfunction()

# limn_fuzzer(NAME [CORPUS folder] SOURCES cpp... LINK lib...): a libFuzzer target, fuzz_NAME, and a test that runs it for
# LIMN_FUZZ_SECONDS from the corpus (tests/fuzz/corpus/NAME where none is named). The libraries that it links tell it
# what they ran. One seed: a run that fails here fails elsewhere; to look further, give the program another.
function(limn_fuzzer name)
  cmake_parse_arguments(ARG "" "CORPUS" "SOURCES;LINK" ${ARGN})
  set(target fuzz_${name})
  add_executable(${target} ${ARG_SOURCES})
  limn_warnings(${target})
  target_link_libraries(${target} PRIVATE ${ARG_LINK})
  target_compile_options(${target} PRIVATE -fsanitize=fuzzer-no-link)
  target_link_options(${target} PRIVATE -fsanitize=fuzzer)
  foreach(library ${ARG_LINK})
    get_target_property(aliased ${library} ALIASED_TARGET)
    target_compile_options(${aliased} PRIVATE -fsanitize=fuzzer-no-link)
  endforeach()

  # What it finds on the way goes into the first folder, and stays there for the next run.
  set(found "${CMAKE_CURRENT_BINARY_DIR}/${name}")
  file(MAKE_DIRECTORY "${found}/corpus")
  set(kept ${ARG_CORPUS})
  if(NOT kept AND IS_DIRECTORY "${PROJECT_SOURCE_DIR}/tests/fuzz/corpus/${name}")
    set(kept "${PROJECT_SOURCE_DIR}/tests/fuzz/corpus/${name}")
  endif()
  add_test(NAME fuzz.${name}
    COMMAND ${target} -seed=1 -max_total_time=${LIMN_FUZZ_SECONDS} -timeout=20 -rss_limit_mb=2048 -print_final_stats=1
            "-artifact_prefix=${found}/" "${found}/corpus" ${kept})
  math(EXPR patience "${LIMN_FUZZ_SECONDS} + 60")
  set_tests_properties(fuzz.${name} PROPERTIES LABELS fuzz TIMEOUT ${patience} COST ${LIMN_FUZZ_SECONDS})
endfunction()

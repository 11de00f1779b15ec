# SPDX-License-Identifier: Apache-2.0
# The two helpers of this project: a library of one folder, and one test.

add_library(strainwave_options INTERFACE)
target_compile_options(strainwave_options INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion
  # g++ 12 warns of overlap wherever a string literal is put before a std::string (GCC bug 105651).
  -Wno-restrict
  # The numbers stay IEEE; only errno and trap bookkeeping is given up.
  -fno-math-errno -fno-trapping-math
  # The compiler collects no garbage below 2 GB, where Eigen's files do not come: up to a quarter of its time.
  $<$<CXX_COMPILER_ID:GNU>:--param=ggc-min-heapsize=2000000>
  $<$<BOOL:${STRAINWAVE_WARNINGS_AS_ERRORS}>:-Werror>)
target_include_directories(strainwave_options INTERFACE ${PROJECT_SOURCE_DIR})
if(STRAINWAVE_SANITIZE)
  # g++ 12 takes the standard library's own std::function for uninitialized when it instruments it.
  target_compile_options(strainwave_options INTERFACE
    -Wno-maybe-uninitialized -fsanitize=${STRAINWAVE_SANITIZE} -fno-sanitize-recover=undefined -fno-omit-frame-pointer)
  target_link_options(strainwave_options INTERFACE -fsanitize=${STRAINWAVE_SANITIZE})
endif()

# strainwave_vector_loops(file ...): files whose loops become vectors as wide as the machine's: optimised in full, each by
# itself, without the header that is compiled ahead. No product is contracted with a sum, so that every machine gives
# the same bits; FAST: it may be.
function(strainwave_vector_loops)
  cmake_parse_arguments(ARG "FAST" "" "" ${ARGN})
  set(contract off)
  if(ARG_FAST)
    set(contract fast)
  endif()
  # Not for vectors whose width is known when the program runs alone: they stand in no array.
  set_source_files_properties(${ARG_UNPARSED_ARGUMENTS} PROPERTIES
    COMPILE_OPTIONS "-O3;-ffp-contract=${contract}" SKIP_PRECOMPILE_HEADERS ON
    COMPILE_DEFINITIONS "HWY_DISABLED_TARGETS=(HWY_SVE|HWY_SVE2|HWY_SVE_256|HWY_SVE2_128|HWY_RVV)")
endfunction()

# strainwave_unity(target): compiles the files of one folder together, STRAINWAVE_UNITY at a time, since most of the
# compiler's time goes into headers that they share. Names in anonymous namespaces differ within a folder for that.
function(strainwave_unity target)
  if(NOT STRAINWAVE_UNITY)
    return()
  endif()
  get_target_property(sources ${target} SOURCES)
  cmake_path(RELATIVE_PATH CMAKE_CURRENT_SOURCE_DIR BASE_DIRECTORY ${PROJECT_SOURCE_DIR} OUTPUT_VARIABLE here)
  set(units)
  set(groups)
  foreach(source IN LISTS sources)
    # What is generated, and what is compiled in a way of its own, as set before the library is made, stays by itself.
    get_property(options SOURCE ${source} PROPERTY COMPILE_OPTIONS)
    get_property(definitions SOURCE ${source} PROPERTY COMPILE_DEFINITIONS)
    if(NOT EXISTS ${CMAKE_CURRENT_SOURCE_DIR}/${source} OR options OR definitions)
      list(APPEND units ${source})
      continue()
    endif()
    cmake_path(GET source PARENT_PATH folder)
    string(MAKE_C_IDENTIFIER "files_${folder}" id)
    math(EXPR count_${id} "${count_${id}} + 1")
    math(EXPR group "(${count_${id}} - 1) / ${STRAINWAVE_UNITY}")
    list(APPEND groups ${id}_${group})
    # CMake's own UNITY_BUILD names absolute paths, of which a checkout elsewhere finds nothing in the compiler's cache.
    cmake_path(SET path NORMALIZE "${here}/${source}")
    string(APPEND text_${id}_${group} "#include \"${path}\"\n")
  endforeach()
  list(REMOVE_DUPLICATES groups)
  foreach(group IN LISTS groups)
    set(unit ${CMAKE_CURRENT_BINARY_DIR}/${target}_units/${group}.cc)
    file(CONFIGURE OUTPUT ${unit} CONTENT "${text_${group}}" @ONLY)
    list(APPEND units ${unit})
  endforeach()
  set_property(TARGET ${target} PROPERTY SOURCES ${units})
endfunction()

# strainwave_library(name SOURCES ... [LINKS ...] [QUICKLY|IN_SHARED]): the static library of one folder.
# QUICKLY: code whose time does not matter. IN_SHARED: it ends in a shared library, too.
function(strainwave_library name)
  cmake_parse_arguments(ARG "QUICKLY;IN_SHARED" "" "SOURCES;LINKS" ${ARGN})
  set(target strainwave_${name})
  add_library(${target} STATIC ${ARG_SOURCES})
  add_library(strainwave::${name} ALIAS ${target})
  target_link_libraries(${target} PUBLIC strainwave_options ${ARG_LINKS})
  strainwave_unity(${target})
  if(ARG_IN_SHARED)
    # Hidden, its functions are called as directly as ever.
    set_target_properties(${target} PROPERTIES
      POSITION_INDEPENDENT_CODE ON CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
  elseif(ARG_QUICKLY)
    strainwave_compile_quickly(${target})
    strainwave_reuse(${target} strainwave_precompiled_quickly)
  else()
    strainwave_reuse(${target} strainwave_precompiled)
  endif()
endfunction()

# strainwave_reuse(target precompiled): reads the headers that `precompiled` has parsed (cmake/precompiled).
function(strainwave_reuse target precompiled)
  target_link_libraries(${target} PRIVATE strainwave_common)
  target_precompile_headers(${target} REUSE_FROM ${precompiled})
  # Beside a precompiled header g++ 12 reports its false bounds of strings within the standard library, too.
  target_compile_options(${target} PRIVATE -Wno-array-bounds -Wno-stringop-overread)
endfunction()

# strainwave_compile_quickly(target): for code whose time does not matter, which compiles in much less of it.
# What g++ 12 says of bounds, of values that are not set and of new and delete is false below -O2.
function(strainwave_compile_quickly target)
  target_compile_options(${target} PRIVATE -O1 -Wno-array-bounds -Wno-maybe-uninitialized
    -Wno-mismatched-new-delete -Wno-stringop-overflow -Wno-stringop-overread)
endfunction()

# strainwave_in_real_time(test ...): devices of these tests live in real time. One at a time, ahead of whatever computes
# beside it; their commands begin with STRAINWAVE_AHEAD.
set(STRAINWAVE_AHEAD ${PROJECT_SOURCE_DIR}/tests/simulation/in_real_time.sh)
function(strainwave_in_real_time)
  set_property(TEST ${ARGN} APPEND PROPERTY LABELS real_time)
  # They wait for each other, so that the first of them begins before anything else.
  set_tests_properties(${ARGN} PROPERTIES RESOURCE_LOCK real_time COST 100)
endfunction()

# Tests that take long: add_test(NAME name ${STRAINWAVE_LONG} COMMAND ...) and strainwave_is_long(name). No part of the
# default tests, which have a shorter one of the same kind, but of `./setup.sh check`, or `ctest --preset long`.
set(STRAINWAVE_LONG CONFIGURATIONS long)
function(strainwave_is_long)
  set_property(TEST ${ARGN} APPEND PROPERTY LABELS long)
  foreach(test IN LISTS ARGN)
    set_tests_properties(${test} PROPERTIES TIMEOUT 3600)
  endforeach()
endfunction()

# strainwave_tests(program FILES <name> ... LINKS ... [LABEL unit|simulation] [TIMEOUT s] [SHARDS <name>=n ...]
#   [LONG <name> ...] [REAL_TIME] [RUNS]):
# tests/<folder>/<name>.cc together in one executable, as linking and parsing headers are what takes long; each file is a
# test of its own. SHARDS: what waits more than it computes runs in n parts at once. RUNS: they start the program.
# Suites named ...AtLength, and all of the files LONG, are tests NAME_at_length, which take long.
function(strainwave_tests program)
  cmake_parse_arguments(ARG "REAL_TIME;RUNS" "LABEL;TIMEOUT" "FILES;LINKS;LONG;SHARDS" ${ARGN})
  if(NOT ARG_LABEL)
    set(ARG_LABEL unit)
  endif()
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 300)  # against hanging; on a busy machine the longest takes a half of it
  endif()
  list(TRANSFORM ARG_FILES APPEND .cc OUTPUT_VARIABLE sources)
  add_executable(${program} ${sources})
  set_target_properties(${program} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
  target_link_libraries(${program} PRIVATE ${ARG_LINKS} GTest::gtest_main)
  strainwave_compile_quickly(${program})  # what is tested is built as it runs
  target_precompile_headers(${program} REUSE_FROM strainwave_test_pch)
  strainwave_unity(${program})
  if(ARG_RUNS)
    add_dependencies(${program} strainwave)
  endif()
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${sources})
  set(taken)
  foreach(name IN LISTS ARG_FILES)
    file(STRINGS ${name}.cc suites REGEX "^(TYPED_)?TEST(_F|_P)?\\(")
    list(TRANSFORM suites REPLACE "^[A-Z_]+\\(([A-Za-z0-9_]+).*" "\\1")
    list(REMOVE_DUPLICATES suites)
    set(filter)
    set(filter_at_length)
    foreach(suite IN LISTS suites)
      if(suite IN_LIST taken)
        message(FATAL_ERROR "${program}: two files have a test suite ${suite} (must differ, as each file is a test)")
      endif()
      set(length)
      if(suite MATCHES "AtLength$" OR name IN_LIST ARG_LONG)
        set(length _at_length)
      endif()
      string(APPEND filter${length} "${suite}.*:*/${suite}.*:${suite}/*:")
    endforeach()
    if(NOT suites)
      message(FATAL_ERROR "${name}.cc has no test")
    endif()
    list(APPEND taken ${suites})
    foreach(length IN ITEMS "" _at_length)
      if(NOT filter${length})
        continue()
      endif()
      set(test ${name}${length})
      set(runner)
      if(ARG_REAL_TIME)
        set(runner ${STRAINWAVE_AHEAD})
      endif()
      if("${ARG_SHARDS}" MATCHES "(^|;)${test}=([0-9]+)")
        list(APPEND runner ${PROJECT_SOURCE_DIR}/tests/simulation/in_shards.sh ${CMAKE_MATCH_2})
      endif()
      if(length)
        set(configurations ${STRAINWAVE_LONG})
      else()
        set(configurations)
      endif()
      add_test(NAME ${test} ${configurations}
        COMMAND ${runner} $<TARGET_FILE:${program}> --gtest_filter=${filter${length}} WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
      # GoogleTest is content with a filter that nothing passes.
      set_tests_properties(${test} PROPERTIES LABELS ${ARG_LABEL} TIMEOUT ${ARG_TIMEOUT}
                           FAIL_REGULAR_EXPRESSION "Running 0 tests from")
      if(length)
        strainwave_is_long(${test})
      endif()
      if(ARG_REAL_TIME)
        strainwave_in_real_time(${test})
      endif()
    endforeach()
  endforeach()
endfunction()

# strainwave_test(name LINKS ... [as above]): tests/<folder>/<name>.cc as one executable.
function(strainwave_test name)
  strainwave_tests(${name} FILES ${name} ${ARGN})
endfunction()

# SPDX-License-Identifier: Apache-2.0
# The two helpers of this project: a library of one folder, and one test.

add_library(strainwave_options INTERFACE)
target_compile_options(strainwave_options INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion
  # g++ 12 warns of overlap wherever a string literal is put before a std::string (GCC bug 105651).
  -Wno-restrict
  # The numbers stay IEEE; only errno and trap bookkeeping is given up.
  -fno-math-errno -fno-trapping-math
  $<$<BOOL:${STRAINWAVE_WARNINGS_AS_ERRORS}>:-Werror>)
target_include_directories(strainwave_options INTERFACE ${PROJECT_SOURCE_DIR})
if(STRAINWAVE_SANITIZE)
  # g++ 12 takes the standard library's own std::function for uninitialized when it instruments it.
  target_compile_options(strainwave_options INTERFACE
    -Wno-maybe-uninitialized -fsanitize=address,undefined -fno-sanitize-recover=undefined -fno-omit-frame-pointer)
  target_link_options(strainwave_options INTERFACE -fsanitize=address,undefined)
endif()

# strainwave_library(name SOURCES ... [LINKS ...] [PRECOMPILED <header> ...]): the static library of one folder.
# PRECOMPILED: headers of others that most of its files read and that take long.
function(strainwave_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINKS;PRECOMPILED" ${ARGN})
  add_library(strainwave_${name} STATIC ${ARG_SOURCES})
  add_library(strainwave::${name} ALIAS strainwave_${name})
  target_link_libraries(strainwave_${name} PUBLIC strainwave_options ${ARG_LINKS})
  if(ARG_PRECOMPILED)
    target_precompile_headers(strainwave_${name} PRIVATE ${ARG_PRECOMPILED})
    # Beside a precompiled header g++ 12 reports its false bounds of strings within the standard library, too.
    target_compile_options(strainwave_${name} PRIVATE -Wno-array-bounds -Wno-stringop-overread)
  endif()
endfunction()

# strainwave_test(name LINKS ... [LABEL unit|simulation]): tests/<folder>/<name>.cc as one executable.
function(strainwave_test name)
  cmake_parse_arguments(ARG "" "LABEL;TIMEOUT" "LINKS" ${ARGN})
  if(NOT ARG_LABEL)
    set(ARG_LABEL unit)
  endif()
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 120)
  endif()
  add_executable(${name} ${name}.cc)
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
  target_link_libraries(${name} PRIVATE ${ARG_LINKS} GTest::gtest_main)
  target_compile_definitions(${name} PRIVATE
    STRAINWAVE_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
    STRAINWAVE_PROGRAM="${CMAKE_BINARY_DIR}/strainwave")
  target_precompile_headers(${name} REUSE_FROM strainwave_test_pch)
  add_test(NAME ${name} COMMAND ${name} WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
  set_tests_properties(${name} PROPERTIES LABELS ${ARG_LABEL} TIMEOUT ${ARG_TIMEOUT})
endfunction()

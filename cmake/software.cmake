# SPDX-License-Identifier: Apache-2.0
# What a program calls itself (daq/software.h). Run as a script in every build it writes SOFTWARE_SOURCE where the commit
# has changed; included, it has strainwave_program(target), which gives a program its own.
if(CMAKE_SCRIPT_MODE_FILE)
  set(software "strainwave ${SOFTWARE_VERSION}")
  # Of this checkout: a source archive may lie within another one.
  if(EXISTS ${SOFTWARE_CHECKOUT}/.git AND SOFTWARE_GIT)
    # A checkout may belong to another user than the one who builds it.
    execute_process(COMMAND ${SOFTWARE_GIT} --no-optional-locks -c safe.directory=${SOFTWARE_CHECKOUT} describe
      --always --exclude=* --dirty
      WORKING_DIRECTORY ${SOFTWARE_CHECKOUT} OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
    if(commit)
      string(APPEND software " (${commit})")
    endif()
  endif()
  file(CONFIGURE OUTPUT ${SOFTWARE_SOURCE} @ONLY CONTENT [[
#include "daq/software.h"

std::string_view strainwave::daq::Software() { return "@software@"; }
]])
  return()
endif()

find_package(Git QUIET)
set(STRAINWAVE_SOFTWARE_SOURCE ${PROJECT_BINARY_DIR}/software.cc)
add_custom_target(strainwave_software
  COMMAND ${CMAKE_COMMAND} -D SOFTWARE_CHECKOUT=${PROJECT_SOURCE_DIR} -D SOFTWARE_VERSION=${PROJECT_VERSION}
    -D SOFTWARE_GIT=${GIT_EXECUTABLE} -D SOFTWARE_SOURCE=${STRAINWAVE_SOFTWARE_SOURCE} -P ${CMAKE_CURRENT_LIST_FILE}
  BYPRODUCTS ${STRAINWAVE_SOFTWARE_SOURCE} COMMENT "Which commit it is" VERBATIM)

function(strainwave_program target)
  target_sources(${target} PRIVATE ${STRAINWAVE_SOFTWARE_SOURCE})
  add_dependencies(${target} strainwave_software)
endfunction()

# SPDX-License-Identifier: Apache-2.0
# Files in a program. Run as a script it writes OUTPUT, C++ with FUNCTION() as StaticFiles() of bench/page/static_files.h,
# from FILES ("PATH_OF_REQUEST=FILE", separated by '|'); included, it has strainwave_embed(target function files...).
if(CMAKE_SCRIPT_MODE_FILE)
  set(types .html=text/html .css=text/css .mjs=text/javascript .js=text/javascript .svg=image/svg+xml)
  string(REPLACE "|" ";" FILES "${FILES}")
  set(arrays "")
  set(rows "")
  set(number 0)
  foreach(entry IN LISTS FILES)
    string(REGEX MATCH "^([^=]*)=(.*)$" _ "${entry}")
    set(path ${CMAKE_MATCH_1})
    set(file ${CMAKE_MATCH_2})
    cmake_path(GET file EXTENSION LAST_ONLY extension)
    set(type "")
    foreach(known IN LISTS types)
      if(known MATCHES "^${extension}=(.*)$")
        set(type "${CMAKE_MATCH_1}; charset=utf-8")
      endif()
    endforeach()
    if(NOT type)
      message(FATAL_ERROR "${file}: no media type is known for '${extension}' (expected one of ${types})")
    endif()
    file(READ ${file} bytes HEX)
    string(REGEX REPLACE "(..)" "'\\\\x\\1'," bytes "${bytes}")
    string(APPEND arrays "constexpr char kBytes${number}[] = {${bytes}};\n")
    string(APPEND rows "    {\"${path}\", \"${type}\", {kBytes${number}, sizeof kBytes${number}}},\n")
    math(EXPR number "${number} + 1")
  endforeach()
  file(CONFIGURE OUTPUT ${OUTPUT} @ONLY CONTENT [[
#include "bench/page/static_files.h"

namespace {
@arrays@
constexpr strainwave::bench::StaticFile kFiles[] = {
@rows@};
}  // namespace

namespace strainwave::bench {
std::span<const StaticFile> @FUNCTION@();
std::span<const StaticFile> @FUNCTION@() { return kFiles; }
}  // namespace strainwave::bench
]])
  return()
endif()

set(STRAINWAVE_EMBED ${CMAKE_CURRENT_LIST_FILE})
function(strainwave_embed target function)
  set(output ${CMAKE_CURRENT_BINARY_DIR}/${target}_files.cc)
  set(files "")
  foreach(entry IN LISTS ARGN)
    string(REGEX REPLACE "^[^=]*=" "" file "${entry}")
    list(APPEND files ${file})
  endforeach()
  list(JOIN ARGN "|" entries)
  add_custom_command(OUTPUT ${output}
    COMMAND ${CMAKE_COMMAND} -D OUTPUT=${output} -D FUNCTION=${function} -D "FILES=${entries}" -P ${STRAINWAVE_EMBED}
    DEPENDS ${files} ${STRAINWAVE_EMBED} COMMENT "Embedding the files of ${target}" VERBATIM)
  target_sources(${target} PRIVATE ${output})
endfunction()

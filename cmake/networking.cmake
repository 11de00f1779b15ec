# SPDX-License-Identifier: Apache-2.0
# What a monitor publishes through: MQTT, Modbus TCP and HTTP. None of the three packages brings files for CMake.
foreach(entry "mosquitto:mosquitto.h:mosquitto" "modbus:modbus.h:modbus" "httplib:httplib.h:cpp-httplib")
  string(REPLACE ":" ";" parts ${entry})
  list(GET parts 0 name)
  list(GET parts 1 header)
  list(GET parts 2 library)
  find_path(${name}_INCLUDE_DIR ${header} PATH_SUFFIXES modbus REQUIRED)
  find_library(${name}_LIBRARY ${library} REQUIRED)
  add_library(networking::${name} INTERFACE IMPORTED)
  target_include_directories(networking::${name} SYSTEM INTERFACE ${${name}_INCLUDE_DIR})
  target_link_libraries(networking::${name} INTERFACE ${${name}_LIBRARY})
endforeach()

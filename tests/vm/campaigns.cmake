# SPDX-License-Identifier: Apache-2.0
# Campaigns over vcan, Modbus TCP, TCP streams and a uhid pendant. Sanitizers count for too much of the time of the virtual
# machine, where what is compared in numbers is run always: its counted time keeps every period whatever else the host does.
if(STRAINWAVE_SANITIZE)
  return()
endif()
strainwave_kernel_test(devices_test vcan0,vcan1,uhid,vivid
  /usr/bin/python3 -B ${CMAKE_CURRENT_LIST_DIR}/devices_test.py ${CMAKE_BINARY_DIR})
strainwave_kernel_test(pendant_test vcan0,uhid /usr/bin/python3 -B ${CMAKE_CURRENT_LIST_DIR}/pendant_test.py ${CMAKE_BINARY_DIR})

# Drives on Modbus need no kernel of their own.
add_test(NAME frozen_program_test COMMAND ${STRAINWAVE_AHEAD} /usr/bin/python3 -B ${CMAKE_CURRENT_LIST_DIR}/frozen_program_test.py ${CMAKE_BINARY_DIR} tcp)
set_tests_properties(frozen_program_test PROPERTIES LABELS simulation TIMEOUT 600)
strainwave_in_real_time(frozen_program_test)
add_test(NAME frozen_program_on_canopen ${STRAINWAVE_LONG} COMMAND ${CMAKE_CURRENT_LIST_DIR}/run.sh --image ${CMAKE_BINARY_DIR}/vm
  /usr/bin/python3 -B ${CMAKE_CURRENT_LIST_DIR}/frozen_program_test.py ${CMAKE_BINARY_DIR} canopen)

# replay_test sets the time of day, which is nobody's to do on this machine.
foreach(name canopen_test replay_test)
  add_test(NAME ${name} ${STRAINWAVE_LONG} COMMAND ${CMAKE_CURRENT_LIST_DIR}/run.sh --image ${CMAKE_BINARY_DIR}/vm
    /usr/bin/python3 -B ${CMAKE_CURRENT_LIST_DIR}/${name}.py ${CMAKE_BINARY_DIR})
endforeach()
# Of one cycle nobody knows how well it repeats: 1 % of a value on top of its standard error.
add_test(NAME short_campaign_over_protocols ${STRAINWAVE_LONG} COMMAND ${CMAKE_CURRENT_LIST_DIR}/against_embedded.sh
  ${CMAKE_BINARY_DIR} ${CMAKE_CURRENT_LIST_DIR}/campaign/short.yaml ${CMAKE_BINARY_DIR}/short_campaign_over_protocols
  40 --scatter 1)
set_tests_properties(canopen_test frozen_program_on_canopen replay_test short_campaign_over_protocols PROPERTIES LABELS vm SKIP_RETURN_CODE 77
  ENVIRONMENT VM_SECONDS=1700)
strainwave_is_long(canopen_test frozen_program_on_canopen replay_test short_campaign_over_protocols)

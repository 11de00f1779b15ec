# SPDX-License-Identifier: Apache-2.0
# Campaigns over vcan, Modbus TCP, TCP streams and a uhid pendant, in the virtual machine of run.sh, whose counted time
# keeps every period whatever else the host does (exit code 77: skipped, with words). Sanitizers count for too much of it.
if(STRAINWAVE_SANITIZE)
  return()
endif()
foreach(name devices_test pendant_test replay_test)
  add_test(NAME ${name} COMMAND ${CMAKE_CURRENT_LIST_DIR}/run.sh --image ${CMAKE_BINARY_DIR}/vm
    /usr/bin/python3 -B ${CMAKE_CURRENT_LIST_DIR}/${name}.py ${CMAKE_BINARY_DIR})
endforeach()
# Of one cycle nobody knows how well it repeats: 1 % of a value on top of its standard error.
add_test(NAME short_campaign_over_protocols COMMAND ${CMAKE_CURRENT_LIST_DIR}/against_embedded.sh ${CMAKE_BINARY_DIR}
  ${CMAKE_CURRENT_LIST_DIR}/campaign/short.yaml ${CMAKE_BINARY_DIR}/short_campaign_over_protocols 40 --scatter 1)
set_tests_properties(devices_test pendant_test replay_test short_campaign_over_protocols PROPERTIES LABELS vm TIMEOUT 1800 SKIP_RETURN_CODE 77
  ENVIRONMENT VM_SECONDS=1700)

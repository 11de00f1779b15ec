# SPDX-License-Identifier: Apache-2.0
# Campaigns over vcan, Modbus TCP, TCP streams and a uhid pendant. What is compared in numbers is run in the virtual
# machine always: its counted time keeps every period whatever else the host does. Sanitizers count for too much of it.
if(STRAINWAVE_SANITIZE)
  return()
endif()
function(strainwave_bench_test name parts)
  strainwave_kernel_test(${name} ${parts} /usr/bin/python3 -B ${CMAKE_CURRENT_LIST_DIR}/${name}.py ${CMAKE_BINARY_DIR})
endfunction()
strainwave_bench_test(devices_test vcan0,vcan1,uhid,vivid)
strainwave_bench_test(pendant_test vcan0,uhid)
strainwave_bench_test(canopen_test vcan0,uhid)
# It sets the time of day, which is nobody's to do on this machine.
add_test(NAME replay_test COMMAND ${CMAKE_CURRENT_LIST_DIR}/run.sh --image ${CMAKE_BINARY_DIR}/vm
  /usr/bin/python3 -B ${CMAKE_CURRENT_LIST_DIR}/replay_test.py ${CMAKE_BINARY_DIR})
# Of one cycle nobody knows how well it repeats: 1 % of a value on top of its standard error.
add_test(NAME short_campaign_over_protocols COMMAND ${CMAKE_CURRENT_LIST_DIR}/against_embedded.sh ${CMAKE_BINARY_DIR}
  ${CMAKE_CURRENT_LIST_DIR}/campaign/short.yaml ${CMAKE_BINARY_DIR}/short_campaign_over_protocols 40 --scatter 1)
set_tests_properties(devices_test pendant_test canopen_test replay_test short_campaign_over_protocols PROPERTIES LABELS vm TIMEOUT 1800 SKIP_RETURN_CODE 77
  ENVIRONMENT VM_SECONDS=1700)

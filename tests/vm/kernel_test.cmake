# SPDX-License-Identifier: Apache-2.0
# strainwave_kernel_test(name PART[,PART]... COMMAND...): natively where the kernel has these parts (on_kernel.sh), or in
# the virtual machine of run.sh, or skipped in words (exit code 77). One at a time: they share the kernel's buses and devices.
function(strainwave_kernel_test name parts)
  add_test(NAME ${name} COMMAND ${PROJECT_SOURCE_DIR}/tests/vm/on_kernel.sh ${CMAKE_BINARY_DIR}/vm ${parts} ${ARGN}
    WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
  set_tests_properties(${name} PROPERTIES LABELS vm TIMEOUT 600 SKIP_RETURN_CODE 77 RESOURCE_LOCK kernel_devices)
endfunction()

add_test(NAME canopen_rules_test COMMAND /usr/bin/python3 -B ${PROJECT_SOURCE_DIR}/tests/vm/canopen_rules_test.py)

# SPDX-License-Identifier: Apache-2.0
# strainwave_kernel_test(name PART[,PART]... COMMAND...): a part of the test kernel_tests, which runs it natively where the
# kernel has these parts, and all others together in one virtual machine, or says what is missing (kernel_tests.sh).
function(strainwave_kernel_test name parts)
  list(JOIN ARGN "\" \"" command)
  set_property(GLOBAL APPEND_STRING PROPERTY STRAINWAVE_KERNEL_TESTS "kernel_test ${name} ${parts} \"${command}\"\n")
endfunction()

# strainwave_kernel_tests(): the test, after all calls of the above.
function(strainwave_kernel_tests)
  set(list ${CMAKE_BINARY_DIR}/kernel_tests.list)
  get_property(tests GLOBAL PROPERTY STRAINWAVE_KERNEL_TESTS)
  file(GENERATE OUTPUT ${list} CONTENT "# SPDX-License-Identifier: Apache-2.0\n${tests}")
  add_test(NAME kernel_tests COMMAND ${PROJECT_SOURCE_DIR}/tests/vm/kernel_tests.sh ${CMAKE_BINARY_DIR}/vm ${list}
    WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
  # It takes longer than all others.
  set_tests_properties(kernel_tests PROPERTIES LABELS vm TIMEOUT 3600 SKIP_RETURN_CODE 77 COST 1000
    ENVIRONMENT "VM_SECONDS=3500;STRAINWAVE_IIOD=${CMAKE_BINARY_DIR}/vm/iiod/usr/sbin/iiod")
endfunction()

add_test(NAME canopen_rules_test COMMAND /usr/bin/python3 -B ${PROJECT_SOURCE_DIR}/tests/vm/canopen_rules_test.py)

# SPDX-License-Identifier: Apache-2.0
# Natively where the kernel has uhid; in the virtual machine of run.sh otherwise (exit code 77: skipped, with words).
add_executable(hid_devices_test ${CMAKE_CURRENT_LIST_DIR}/hid_devices_test.cc)
set_target_properties(hid_devices_test PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
target_link_libraries(hid_devices_test PRIVATE strainwave::hid_devices GTest::gtest_main)
add_test(NAME hid_devices_test COMMAND ${CMAKE_CURRENT_LIST_DIR}/run.sh --image ${CMAKE_BINARY_DIR}/vm
  $<TARGET_FILE:hid_devices_test>)
set_tests_properties(hid_devices_test PROPERTIES LABELS vm TIMEOUT 600 SKIP_RETURN_CODE 77)

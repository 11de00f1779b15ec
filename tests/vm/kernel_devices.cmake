# SPDX-License-Identifier: Apache-2.0
# Devices of the kernel, made with uhid or its own test camera: natively where it has them; in the virtual machine of run.sh otherwise (exit
# code 77: skipped, with words).
function(strainwave_kernel_device_test name)
  add_executable(${name} ${CMAKE_CURRENT_LIST_DIR}/${name}.cc)
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
  target_link_libraries(${name} PRIVATE ${ARGN} GTest::gtest_main)
  add_test(NAME ${name} COMMAND ${CMAKE_CURRENT_LIST_DIR}/run.sh --image ${CMAKE_BINARY_DIR}/vm $<TARGET_FILE:${name}>)
  set_tests_properties(${name} PROPERTIES LABELS vm TIMEOUT 600 SKIP_RETURN_CODE 77)
endfunction()
strainwave_kernel_device_test(hid_devices_test strainwave::hid_devices)
strainwave_kernel_device_test(iio_device_test strainwave::acquisition)
strainwave_kernel_device_test(camera_device_test strainwave::camera strainwave::device_listing)
target_compile_definitions(iio_device_test PRIVATE STRAINWAVE_PROGRAM="${CMAKE_BINARY_DIR}/strainwave")
add_dependencies(iio_device_test strainwave)
set_tests_properties(iio_device_test PROPERTIES ENVIRONMENT STRAINWAVE_IIOD=${CMAKE_BINARY_DIR}/vm/iiod/usr/sbin/iiod)

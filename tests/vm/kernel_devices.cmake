# SPDX-License-Identifier: Apache-2.0
# Devices of the kernel, made with uhid or its own test camera.
function(strainwave_kernel_device_test name parts)
  add_executable(${name} ${CMAKE_CURRENT_LIST_DIR}/${name}.cc)
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
  target_link_libraries(${name} PRIVATE ${ARGN} GTest::gtest_main)
  strainwave_compile_quickly(${name})
  target_precompile_headers(${name} REUSE_FROM strainwave_test_pch)
  strainwave_kernel_test(${name} ${parts} $<TARGET_FILE:${name}>)
endfunction()
strainwave_kernel_device_test(hid_devices_test uhid strainwave::hid_devices)
strainwave_kernel_device_test(iio_device_test uhid,hid_sensor_accel_3d strainwave::acquisition)
strainwave_kernel_device_test(camera_device_test vivid strainwave::camera strainwave::device_listing opencv::imgcodecs)
add_dependencies(iio_device_test strainwave)

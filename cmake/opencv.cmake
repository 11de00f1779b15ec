# SPDX-License-Identifier: Apache-2.0
# Four modules of OpenCV and the ONNX messages. The package of OpenCV's CMake files would install all of its modules.
find_path(OPENCV_INCLUDE_DIR opencv2/dnn.hpp PATH_SUFFIXES opencv4 REQUIRED)
foreach(module core dnn imgcodecs ml videoio)
  find_library(OPENCV_${module} opencv_${module} REQUIRED)
  add_library(opencv::${module} INTERFACE IMPORTED)
  target_include_directories(opencv::${module} SYSTEM INTERFACE ${OPENCV_INCLUDE_DIR})
  target_link_libraries(opencv::${module} INTERFACE ${OPENCV_${module}})
endforeach()
target_link_libraries(opencv::dnn INTERFACE ${OPENCV_core})
target_link_libraries(opencv::ml INTERFACE ${OPENCV_core})
target_link_libraries(opencv::imgcodecs INTERFACE ${OPENCV_core})
target_link_libraries(opencv::videoio INTERFACE ${OPENCV_core})

find_package(Protobuf REQUIRED)
find_path(ONNX_INCLUDE_DIR onnx/onnx_pb.h REQUIRED)
find_library(ONNX_PROTO onnx_proto REQUIRED)
add_library(strainwave_onnx INTERFACE)
add_library(strainwave::onnx ALIAS strainwave_onnx)
# Debian's library holds the messages of the -ml schema.
target_compile_definitions(strainwave_onnx INTERFACE ONNX_ML=1 ONNX_NAMESPACE=onnx)
target_include_directories(strainwave_onnx SYSTEM INTERFACE ${ONNX_INCLUDE_DIR})
target_link_libraries(strainwave_onnx INTERFACE ${ONNX_PROTO} protobuf::libprotobuf)

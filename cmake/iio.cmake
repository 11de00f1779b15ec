# SPDX-License-Identifier: Apache-2.0
# libiio, whose Debian package brings no files for CMake.
find_path(iio_INCLUDE_DIR iio.h REQUIRED)
find_library(iio_LIBRARY iio REQUIRED)
add_library(iio::iio INTERFACE IMPORTED)
target_include_directories(iio::iio SYSTEM INTERFACE ${iio_INCLUDE_DIR})
target_link_libraries(iio::iio INTERFACE ${iio_LIBRARY})

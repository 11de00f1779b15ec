// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string_view>

namespace strainwave::bench {

/// A file of the page, as it was when the program was built (cmake/embed.cmake).
struct StaticFile {
  std::string_view path;  // "/page.css"; that of the page itself is "/"
  std::string_view type;  // media type
  std::string_view bytes;
};

std::span<const StaticFile> StaticFiles();

/// By the whole path of a request, and by no other way: nothing leads from here to a file on the disk.
const StaticFile* FindStaticFile(std::string_view path);

}  // namespace strainwave::bench

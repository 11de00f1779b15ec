// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

namespace strainwave::bench {

/// Why a page could not be printed, and what to do.
class PdfError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Prints a page as PDF on A4 through Chromium without a window or a network, whole or not at all; one of
/// that name is replaced. It takes the first browser that the PATH has.
/// @param browsers  names to try
/// @throws PdfError, std::system_error as daq::WriteFileAtomically does.
void WritePdf(const std::string& html, const std::filesystem::path& pdf,
              const std::vector<std::string>& browsers = {"chromium", "chromium-browser", "google-chrome"});

}  // namespace strainwave::bench

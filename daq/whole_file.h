// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

namespace strainwave::daq {

/// The bytes of a file that a user named.
/// @throws RecordError if it is missing, a directory, or not to be read; the message says which.
std::string ReadWholeFile(const std::filesystem::path& path);

/// Writes a file so that it appears whole or not at all, also after a power cut: into `.NAME.partial` beside
/// it, fsync, rename, fsync of the directory. A file of that name is replaced; a partial that a killed
/// process left behind is overwritten. Of several writers at once each has a partial of its own (the further
/// ones `.NAME.1.partial` and so on), and the last one's file stays.
/// @throws DataFileError with the path and the errno of the step that failed; the partial is then removed.
///   Only when the last step fails, the fsync of the directory, is the file there all the same.
void WriteFileAtomically(const std::filesystem::path& path, std::span<const std::byte> bytes);
void WriteFileAtomically(const std::filesystem::path& path, const std::string& text);

}  // namespace strainwave::daq

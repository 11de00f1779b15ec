// SPDX-License-Identifier: Apache-2.0
#include "bench/prediction/specimens.h"

#include <filesystem>
#include <set>
#include <stdexcept>

#include <fmt/format.h>

namespace strainwave::bench {
namespace {

namespace fs = std::filesystem;

std::string FolderOf(const fs::path& file) {
  return fs::absolute(file).lexically_normal().parent_path().string();
}

}  // namespace

SpecimenPer SpecimenPerOf(std::string_view name) {
  if (name == "file") return SpecimenPer::kFile;
  if (name == "folder") return SpecimenPer::kFolder;
  throw std::invalid_argument(fmt::format("there are no specimens per {} (expected file or folder)", name));
}

SpecimensFound NameSpecimens(std::vector<SourceRows>& sources, SpecimenPer per) {
  std::set<std::string> files;
  std::set<std::string> folders;
  for (SourceRows& rows : sources) {
    if (!rows.specimen.empty()) continue;
    if (fs::is_directory(rows.source)) {
      rows.specimen = rows.source.string();
      continue;
    }
    files.insert(rows.source.string());
    folders.insert(FolderOf(rows.source));
  }
  if (files.empty()) return {};
  const bool several = folders.size() > 1 && folders.size() < files.size();
  const bool by_folder = per == SpecimenPer::kFolder || (per == SpecimenPer::kGuessed && several);
  for (SourceRows& rows : sources) {
    if (rows.specimen.empty()) rows.specimen = by_folder ? FolderOf(rows.source) : rows.source.string();
  }
  const std::string in =
      fmt::format("{} file{} in {} folder{} name{} no specimen", files.size(), files.size() == 1 ? "" : "s",
                  folders.size(), folders.size() == 1 ? "" : "s", files.size() == 1 ? "s" : "");
  constexpr const char* kExpected =
      "(expected `# specimen: NAME` in the metadata of each, or --specimen-per file or folder)";
  return {
      by_folder ? "folder" : "file",
      by_folder
          ? fmt::format("{}: each folder is taken for a specimen, {} in all {}", in, folders.size(),
                        kExpected)
          : fmt::format("{}: each file is taken for a specimen, {} in all; where several are of one, what is "
                        "told of unseen specimens flatters {}",
                        in, files.size(), kExpected)};
}

}  // namespace strainwave::bench

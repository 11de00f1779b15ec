// SPDX-License-Identifier: Apache-2.0
#include "tests/power_cuts/disk.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <set>
#include <stdexcept>

namespace strainwave::power_cuts {
namespace {

std::timespec TimeOfDay() {
  std::timespec now{};
  std::timespec_get(&now, TIME_UTC);
  return now;
}

std::string BytesOf(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw std::runtime_error("cannot read " + path.string());
  return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace

Disk::Disk() {
  folders_[kRoot];
  names_[kRoot] = "/";
}

void Disk::Load(const std::filesystem::path& folder) {
  std::map<std::filesystem::path, Number> numbers{{folder, kRoot}};
  // A folder is met before what lies in it.
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    const Number parent = numbers.at(entry.path().parent_path());
    const Number number = Make(parent, entry.path().filename().string(), entry.is_directory());
    if (entry.is_directory()) {
      numbers[entry.path()] = number;
    } else {
      Write(number, 0, BytesOf(entry.path()));
      Sync(number);
    }
    Sync(parent);
  }
}

void Disk::Store(const std::filesystem::path& folder, Side side) const { StoreFolder(folder, kRoot, side); }

void Disk::StoreFolder(const std::filesystem::path& path, Number number, Side side) const {
  if (!std::filesystem::create_directory(path)) throw std::runtime_error(path.string() + " is there already");
  const Folder& folder = folders_.at(number);
  for (const auto& [name, held] : side == Side::kSeen ? folder.seen : folder.synced) {
    if (folders_.contains(held)) {
      StoreFolder(path / name, held, side);
      continue;
    }
    const std::string& bytes = side == Side::kSeen ? files_.at(held).seen : files_.at(held).synced;
    std::ofstream(path / name, std::ios::binary) << bytes;
  }
}

std::optional<Number> Disk::Find(Number folder, const std::string& name) const {
  const auto& names = folders_.at(folder).seen;
  const auto found = names.find(name);
  return found == names.end() ? std::nullopt : std::optional(found->second);
}

Disk::Shape Disk::ShapeOf(Number number) const {
  if (folders_.contains(number)) return {.is_folder = true};
  const File& file = files_.at(number);
  return {.is_folder = false, .bytes = file.seen.size(), .changed = file.changed};
}

std::string Disk::Read(Number file, std::size_t offset, std::size_t bytes) const {
  const std::string& seen = files_.at(file).seen;
  return offset < seen.size() ? seen.substr(offset, bytes) : std::string();
}

void Disk::Apply(const NameChange& change, std::map<std::string, Number>& names) {
  if (!change.goes.empty()) names.erase(change.goes);
  if (!change.comes.empty()) names[change.comes] = change.number;
}

Number Disk::Make(Number folder, const std::string& name, bool is_folder) {
  const Number number = ++last_;
  if (is_folder) {
    folders_[number];
  } else {
    files_[number].changed = TimeOfDay();
  }
  names_[number] = name;
  Folder& parent = folders_.at(folder);
  Apply(parent.waiting.emplace_back(NameChange{{}, name, number}), parent.seen);
  return number;
}

void Disk::Remove(Number folder, const std::string& name) {
  Folder& parent = folders_.at(folder);
  Apply(parent.waiting.emplace_back(NameChange{name, {}, 0}), parent.seen);
}

void Disk::Rename(Number from_folder, const std::string& from, Number to_folder, const std::string& to) {
  const Number number = folders_.at(from_folder).seen.at(from);
  names_[number] = to;
  Folder& target = folders_.at(to_folder);
  if (from_folder == to_folder) {
    Apply(target.waiting.emplace_back(NameChange{from, to, number}), target.seen);
    return;
  }
  Apply(target.waiting.emplace_back(NameChange{{}, to, number}), target.seen);
  Remove(from_folder, from);
}

void Disk::Put(std::size_t offset, std::string_view bytes, char between, std::string& into) {
  if (into.size() < offset + bytes.size()) into.resize(offset + bytes.size(), between);
  into.replace(offset, bytes.size(), bytes);
}

void Disk::Write(Number number, std::size_t offset, std::string_view bytes) {
  File& file = files_.at(number);
  Put(offset, bytes, '\0', file.seen);
  // What was dropped comes along with its page when that is written again.
  const std::size_t first = file.dropped ? offset / kPage_bytes * kPage_bytes : offset;
  const std::size_t last =
      file.dropped
          ? std::min(file.seen.size(), (offset + bytes.size() + kPage_bytes - 1) / kPage_bytes * kPage_bytes)
          : offset + bytes.size();
  file.waiting.push_back({.resizes = false, .offset = first, .bytes = file.seen.substr(first, last - first)});
  file.changed = TimeOfDay();
}

void Disk::Resize(Number number, std::size_t bytes) {
  File& file = files_.at(number);
  file.seen.resize(bytes);
  file.waiting.push_back({.resizes = true, .offset = bytes});
  file.changed = TimeOfDay();
}

void Disk::Sync(Number number) {
  if (const auto folder = folders_.find(number); folder != folders_.end()) {
    folder->second.synced = folder->second.seen;
    folder->second.waiting.clear();
    return;
  }
  File& file = files_.at(number);
  // What a failed sync has dropped differs from what is seen, and is not written now either.
  for (const Change& change : file.waiting) {
    if (change.resizes) {
      file.synced.resize(change.offset);
    } else {
      Put(change.offset, change.bytes, '\0', file.synced);
    }
  }
  file.waiting.clear();
}

bool Disk::Happens(double share) { return std::uniform_real_distribution<double>(0.0, 1.0)(chance_) < share; }

// Nothing and all are as likely as something between.
double Disk::Share() {
  switch (std::uniform_int_distribution<int>(0, 3)(chance_)) {
    case 0:
      return 0.0;
    case 1:
      return 1.0;
    default:
      return std::uniform_real_distribution<double>(0.0, 1.0)(chance_);
  }
}

// Each sector for itself, so that a write is there in part, and a later one without the one before it.
void Disk::KeepSome(File& file) {
  const double share = Share();
  // A length may be on the disk before the data, for which there is then anything.
  const char between = Happens(0.5) ? '\0' : '\xA5';
  for (const Change& change : file.waiting) {
    if (change.resizes) {
      if (Happens(share)) file.synced.resize(change.offset, between);
      continue;
    }
    const std::string_view bytes = change.bytes;
    for (std::size_t at = 0; at < bytes.size();) {
      const std::size_t offset = change.offset + at;
      const std::size_t part = std::min(bytes.size() - at, kSector_bytes - offset % kSector_bytes);
      if (Happens(share)) Put(offset, bytes.substr(at, part), between, file.synced);
      at += part;
    }
  }
  if (!file.waiting.empty() && file.synced.size() < file.seen.size() && Happens(share)) {
    file.synced.resize(file.seen.size(), between);
  }
  file.waiting.clear();
}

void Disk::FailSync(Number number) {
  if (const auto file = files_.find(number); file != files_.end()) {
    KeepSome(file->second);
    file->second.dropped = true;
  }
}

void Disk::Cut() {
  // In the order of numbers, so that the same seed gives the same disk.
  for (const auto& [number, name] : std::map(names_.begin(), names_.end())) {
    if (const auto file = files_.find(number); file != files_.end()) {
      KeepSome(file->second);
      file->second.seen = file->second.synced;
      continue;
    }
    Folder& folder = folders_.at(number);
    const double share = Share();
    for (const NameChange& change : folder.waiting) {
      if (Happens(share)) Apply(change, folder.synced);
    }
    folder.waiting.clear();
    folder.seen = folder.synced;
  }
}

}  // namespace strainwave::power_cuts

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <ctime>
#include <filesystem>
#include <map>
#include <optional>
#include <random>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

namespace strainwave::power_cuts {

/// Of a file or folder, as an inode's; names lead to it.
using Number = std::uint64_t;

/// A disk behind a cache, in memory: what the program sees, what is certain to be there after a power cut,
/// and what has been written since and may be there or not. README.md says what is promised and why no more.
class Disk {
 public:
  static constexpr Number kRoot = 1;
  /// What a disk writes whole or not at all.
  static constexpr std::size_t kSector_bytes = 512;
  /// What the cache writes at once.
  static constexpr std::size_t kPage_bytes = 4096;

  /// Of a file, the length; of a folder, nothing.
  struct Shape {
    bool is_folder{};
    std::size_t bytes{};
    std::timespec changed{};
  };
  enum class Side { kSeen, kSynced };

  Disk();
  /// Everything in `folder`, synced.
  void Load(const std::filesystem::path& folder);
  /// Makes `folder`, which must not be there.
  void Store(const std::filesystem::path& folder, Side side) const;

  std::optional<Number> Find(Number folder, const std::string& name) const;
  Shape ShapeOf(Number number) const;
  const std::map<std::string, Number>& NamesIn(Number folder) const { return folders_.at(folder).seen; }
  std::string Read(Number file, std::size_t offset, std::size_t bytes) const;
  /// The last name that it had, for messages.
  const std::string& NameOf(Number number) const { return names_.at(number); }

  Number Make(Number folder, const std::string& name, bool is_folder);
  void Remove(Number folder, const std::string& name);
  void Rename(Number from_folder, const std::string& from, Number to_folder, const std::string& to);
  void Write(Number file, std::size_t offset, std::string_view bytes);
  void Resize(Number file, std::size_t bytes);
  /// Of a file its bytes and length, of a folder its names.
  void Sync(Number number);
  /// As a kernel does that could not write: some of what was to be written is on the disk, nothing is tried
  /// again, and what the program sees stays. Names of a folder are still waiting.
  void FailSync(Number file);
  /// The power goes, and comes back: of everything that waits some is on the disk, and nothing waits any
  /// more.
  void Cut();

  /// From which `Cut` and `FailSync` take what is kept.
  void Seed(std::uint64_t seed) { chance_.seed(seed); }

 private:
  struct Change {
    bool resizes{};
    std::size_t offset{};  // of a change of the length the new one
    std::string bytes{};
  };
  struct File {
    std::string seen;
    std::string synced;
    std::vector<Change> waiting;
    std::timespec changed{};
    bool dropped{};  // a sync has failed
  };
  /// One step that a file system does whole: a name goes, one comes, or both.
  struct NameChange {
    std::string goes;
    std::string comes;
    Number number{};
  };
  struct Folder {
    std::map<std::string, Number> seen;
    std::map<std::string, Number> synced;
    std::vector<NameChange> waiting;
  };

  static void Apply(const NameChange& change, std::map<std::string, Number>& names);
  static void Put(std::size_t offset, std::string_view bytes, char between, std::string& into);
  bool Happens(double share);
  double Share();
  void KeepSome(File& file);
  void StoreFolder(const std::filesystem::path& path, Number number, Side side) const;

  std::unordered_map<Number, File> files_;
  std::unordered_map<Number, Folder> folders_;
  std::unordered_map<Number, std::string> names_;
  Number last_ = kRoot;
  std::mt19937_64 chance_;
};

}  // namespace strainwave::power_cuts

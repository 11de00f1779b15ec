// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/checked_pages.h"

#include <sqlite3.h>

#include <array>
#include <cstring>
#include <filesystem>
#include <new>
#include <string>
#include <system_error>

#include "bench/campaign/page_checksums.h"

namespace strainwave::bench {
namespace {

// What SQLite is given as its file; the file of the VFS below lies right behind it.
struct CheckedFile {
  sqlite3_file base{};
  bool checked{};
  bool immutable{};

  sqlite3_file* below() { return reinterpret_cast<sqlite3_file*>(this + 1); }
};

CheckedFile& Of(sqlite3_file* file) { return *reinterpret_cast<CheckedFile*>(file); }
sqlite3_file* Below(sqlite3_file* file) { return Of(file).below(); }
const sqlite3_io_methods& MethodsBelow(sqlite3_file* file) { return *Below(file)->pMethods; }

bool IsPage(const CheckedFile& file, int bytes, sqlite3_int64 at) {
  return file.checked && bytes == kPage_bytes && at % static_cast<sqlite3_int64>(kPage_bytes) == 0;
}

std::uint32_t NumberOf(sqlite3_int64 at) {
  return static_cast<std::uint32_t>(at / static_cast<sqlite3_int64>(kPage_bytes)) + 1;
}

int Read(sqlite3_file* file, void* into, int bytes, sqlite3_int64 at) {
  const int code = MethodsBelow(file).xRead(Below(file), into, bytes, at);
  if (code != SQLITE_OK || !IsPage(Of(file), bytes, at)) return code;
  const PageBytes page(static_cast<std::byte*>(into), kPage_bytes);
  if (StateOf(page, NumberOf(at)) == PageState::kDamaged) return SQLITE_IOERR_DATA;
  // From here the page may go into the write-ahead log, where its checksum would soon be an old one.
  UnsealPage(page);
  return SQLITE_OK;
}

int Write(sqlite3_file* file, const void* from, int bytes, sqlite3_int64 at) {
  // The first page of a new database says whether there is room for checksums.
  if (at == 0 && bytes == kPage_bytes) {
    Of(file).checked = HasPageChecksums({static_cast<const std::byte*>(from), kPage_bytes});
  }
  if (!IsPage(Of(file), bytes, at)) return MethodsBelow(file).xWrite(Below(file), from, bytes, at);
  std::array<std::byte, kPage_bytes> sealed;
  std::memcpy(sealed.data(), from, sealed.size());
  SealPage(sealed, NumberOf(at));
  return MethodsBelow(file).xWrite(Below(file), sealed.data(), bytes, at);
}

int DeviceCharacteristics(sqlite3_file* file) {
  const int below = MethodsBelow(file).xDeviceCharacteristics(Below(file));
  return Of(file).immutable ? below | SQLITE_IOCAP_IMMUTABLE : below;
}

// Version 2: no memory mapping, past which pages would be read.
constexpr sqlite3_io_methods kMethods{
    .iVersion = 2,
    .xClose = [](sqlite3_file* f) { return MethodsBelow(f).xClose(Below(f)); },
    .xRead = Read,
    .xWrite = Write,
    .xTruncate = [](sqlite3_file* f,
                    sqlite3_int64 size) { return MethodsBelow(f).xTruncate(Below(f), size); },
    .xSync = [](sqlite3_file* f, int flags) { return MethodsBelow(f).xSync(Below(f), flags); },
    .xFileSize = [](sqlite3_file* f,
                    sqlite3_int64* size) { return MethodsBelow(f).xFileSize(Below(f), size); },
    .xLock = [](sqlite3_file* f, int lock) { return MethodsBelow(f).xLock(Below(f), lock); },
    .xUnlock = [](sqlite3_file* f, int lock) { return MethodsBelow(f).xUnlock(Below(f), lock); },
    .xCheckReservedLock = [](sqlite3_file* f,
                             int* result) { return MethodsBelow(f).xCheckReservedLock(Below(f), result); },
    .xFileControl = [](sqlite3_file* f, int what,
                       void* argument) { return MethodsBelow(f).xFileControl(Below(f), what, argument); },
    .xSectorSize = [](sqlite3_file* f) { return MethodsBelow(f).xSectorSize(Below(f)); },
    .xDeviceCharacteristics = DeviceCharacteristics,
    .xShmMap =
        [](sqlite3_file* f, int region, int size, int extend, void volatile** memory) {
          return MethodsBelow(f).xShmMap(Below(f), region, size, extend, memory);
        },
    .xShmLock = [](sqlite3_file* f, int offset, int count,
                   int flags) { return MethodsBelow(f).xShmLock(Below(f), offset, count, flags); },
    .xShmBarrier = [](sqlite3_file* f) { MethodsBelow(f).xShmBarrier(Below(f)); },
    .xShmUnmap = [](sqlite3_file* f, int remove) { return MethodsBelow(f).xShmUnmap(Below(f), remove); },
    .xFetch = nullptr,
    .xUnfetch = nullptr,
};

bool HasLog(const char* name) {
  std::error_code none;
  const auto bytes = std::filesystem::file_size(std::string(name) + "-wal", none);
  return !none && bytes > 0;
}

class CheckedVfs {
 public:
  CheckedVfs(const char* name, const char* below, Sharing sharing)
      : vfs_(*sqlite3_vfs_find(below)), below_(sqlite3_vfs_find(below)), sharing_(sharing) {
    vfs_.pNext = nullptr;
    vfs_.zName = name;
    vfs_.szOsFile = static_cast<int>(sizeof(CheckedFile)) + below_->szOsFile;
    vfs_.xOpen = Open;
    // All else is called with this object, in which its own data are those of the VFS below.
    sqlite3_vfs_register(&vfs_, 0);
  }

 private:
  static int Open(sqlite3_vfs* vfs, const char* name, sqlite3_file* file, int flags, int* out_flags) {
    const auto& self = *reinterpret_cast<const CheckedVfs*>(vfs);
    if ((flags & SQLITE_OPEN_MAIN_DB) == 0)
      return self.below_->xOpen(self.below_, name, file, flags, out_flags);
    auto* const opened = new (file) CheckedFile;
    const int code = self.below_->xOpen(self.below_, name, opened->below(), flags, out_flags);
    if (code != SQLITE_OK) return code;
    opened->base.pMethods = &kMethods;
    std::array<std::byte, kPage_bytes> first{};
    if (MethodsBelow(file).xRead(Below(file), first.data(), kPage_bytes, 0) == SQLITE_OK) {
      opened->checked = HasPageChecksums(first);
    }
    // Without a log to be read, SQLite would still want to make one.
    opened->immutable = self.sharing_ == Sharing::kSettled && !HasLog(name);
    return SQLITE_OK;
  }

  sqlite3_vfs vfs_;  // first, so that SQLite's pointer to it is one to this object
  sqlite3_vfs* below_;
  Sharing sharing_;
};

}  // namespace

const char* CheckedPages(Sharing sharing) {
  static CheckedVfs shared("strainwave-shared", "unix", Sharing::kShared);
  static CheckedVfs settled("strainwave-settled", "unix-none", Sharing::kSettled);
  return sharing == Sharing::kShared ? "strainwave-shared" : "strainwave-settled";
}

}  // namespace strainwave::bench

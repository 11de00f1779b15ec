// SPDX-License-Identifier: Apache-2.0
// A file system whose power goes with the k-th operation; README.md says what it promises.
//
//   power_cut_disk FOLDER MOUNTPOINT [cut-at=K] [fail-sync=N [cut-after=J]] [forget=END] [seed=S]
//                  [fail-at=K errno=E [lasting=1] [only=OPERATION]] [write-ms=T]
//
// Begins with what lies in FOLDER/disk. With the K-th operation that changes something or syncs, the process
// that asked is killed, FOLDER/seen gets what it saw, FOLDER/synced what was promised to stay, and
// FOLDER/disk what stays. From then on everything is answered with EIO. Without a cut the same happens when
// the file system is unmounted (SIGTERM). The N-th sync fails, once; the power may go J operations after
// that. Syncs of what has a name with this END do nothing. fail-at and write-ms: fault_plan.h; with SIGUSR1 a
// fault that lasts is over, with SIGUSR2 writes become slow, or quick. Standard output: "mounted", and at the
// end a line of JSON.
#define FUSE_USE_VERSION 314
#include <fcntl.h>
#include <fuse_lowlevel.h>
#include <sys/prctl.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "tests/power_cuts/disk.h"
#include "tests/power_cuts/fault_plan.h"

namespace strainwave::power_cuts {
namespace {

// Nothing changes a file behind the kernel's back.
constexpr double kForever_s = 1e6;
constexpr std::size_t kDisk_blocks = 4 << 20;
constexpr std::size_t kBlock_bytes = 4096;

struct PowerCutDisk {
  Disk disk;
  std::filesystem::path folder;
  unsigned long cut_at{};     // operations from 1; 0: never
  unsigned long fail_sync{};  // syncs from 1; 0: none
  unsigned long cut_after{};  // operations from the failed sync; 0: never
  std::optional<std::string> forgotten{};
  FaultPlan faults{};
  unsigned long operations{};
  unsigned long syncs{};
  bool off{};
  std::string last_operation{};
  std::string failed_sync{};

  void Cut() {
    off = true;
    disk.Store(folder / "seen", Disk::Side::kSeen);
    disk.Store(folder / "synced", Disk::Side::kSynced);
    disk.Cut();
    std::filesystem::remove_all(folder / "disk");
    disk.Store(folder / "disk", Disk::Side::kSynced);
  }

  /// Whether the power goes with this operation.
  bool Count(fuse_req_t request, const char* what, Number number) {
    last_operation = std::string(what) + " " + disk.NameOf(number);
    if (++operations != cut_at) return false;
    ::kill(fuse_req_ctx(request)->pid, SIGKILL);
    Cut();
    return true;
  }
};

PowerCutDisk& Of(fuse_req_t request) { return *static_cast<PowerCutDisk*>(fuse_req_userdata(request)); }

struct stat Attributes(const Disk& disk, Number number) {
  const Disk::Shape shape = disk.ShapeOf(number);
  struct stat attributes {};
  attributes.st_ino = number;
  attributes.st_mode = shape.is_folder ? S_IFDIR | 0755 : S_IFREG | 0644;
  attributes.st_nlink = shape.is_folder ? 2 : 1;
  attributes.st_size = static_cast<off_t>(shape.bytes);
  attributes.st_blocks = static_cast<blkcnt_t>((shape.bytes + 511) / 512);
  attributes.st_mtim = attributes.st_ctim = attributes.st_atim = shape.changed;
  return attributes;
}

fuse_entry_param Entry(const Disk& disk, Number number) {
  fuse_entry_param entry{};
  entry.ino = number;
  entry.generation = 1;
  entry.attr = Attributes(disk, number);
  entry.attr_timeout = entry.entry_timeout = kForever_s;
  return entry;
}

/// Does `answer` while there is power, and says what is wrong otherwise.
template <typename Answer>
void WithPower(fuse_req_t request, Answer answer) {
  PowerCutDisk& served = Of(request);
  if (served.off) {
    fuse_reply_err(request, EIO);
  } else {
    answer(served);
  }
}

/// The same for an operation that the plan of faults may have fail.
template <typename Answer>
void WithFaults(fuse_req_t request, Operation operation, const std::string& name, Answer answer) {
  WithPower(request, [&](PowerCutDisk& served) {
    if (const int error = served.faults.Meet(operation, name); error != 0) {
      fuse_reply_err(request, error);
    } else {
      answer(served);
    }
  });
}

/// After a change: the answer is EIO where the power went with it.
void ReplyToChange(fuse_req_t request, const char* what, Number number) {
  fuse_reply_err(request, Of(request).Count(request, what, number) ? EIO : 0);
}

void Init(void*, fuse_conn_info* connection) {
  // A file that is opened to be emptied is then emptied by an operation of its own.
  connection->want &= ~static_cast<unsigned>(FUSE_CAP_ATOMIC_O_TRUNC);
}

void LookUp(fuse_req_t request, fuse_ino_t folder, const char* name) {
  WithFaults(request, Operation::kLookUp, name, [&](const PowerCutDisk& served) {
    const auto number = served.disk.Find(folder, name);
    if (!number) {
      fuse_reply_err(request, ENOENT);
      return;
    }
    const fuse_entry_param entry = Entry(served.disk, *number);
    fuse_reply_entry(request, &entry);
  });
}

void GetAttributes(fuse_req_t request, fuse_ino_t number, fuse_file_info*) {
  WithPower(request, [&](const PowerCutDisk& served) {
    const struct stat attributes = Attributes(served.disk, number);
    fuse_reply_attr(request, &attributes, kForever_s);
  });
}

// Rights and times are not kept.
void SetAttributes(fuse_req_t request, fuse_ino_t number, struct stat* wanted, int which, fuse_file_info*) {
  WithPower(request, [&](PowerCutDisk& served) {
    if ((which & FUSE_SET_ATTR_SIZE) != 0) {
      if (const int error = served.faults.Meet(Operation::kResize, served.disk.NameOf(number)); error != 0) {
        fuse_reply_err(request, error);
        return;
      }
      served.disk.Resize(number, static_cast<std::size_t>(wanted->st_size));
      if (served.Count(request, "truncate", number)) {
        fuse_reply_err(request, EIO);
        return;
      }
    }
    const struct stat attributes = Attributes(served.disk, number);
    fuse_reply_attr(request, &attributes, kForever_s);
  });
}

void MakeFolder(fuse_req_t request, fuse_ino_t parent, const char* name, mode_t) {
  WithFaults(request, Operation::kMakeFolder, name, [&](PowerCutDisk& served) {
    const Number number = served.disk.Make(parent, name, true);
    const fuse_entry_param entry = Entry(served.disk, number);
    if (served.Count(request, "mkdir", number)) {
      fuse_reply_err(request, EIO);
    } else {
      fuse_reply_entry(request, &entry);
    }
  });
}

void Create(fuse_req_t request, fuse_ino_t parent, const char* name, mode_t, fuse_file_info* file) {
  WithFaults(request, Operation::kCreate, name, [&](PowerCutDisk& served) {
    const Number number = served.disk.Make(parent, name, false);
    const fuse_entry_param entry = Entry(served.disk, number);
    if (served.Count(request, "create", number)) {
      fuse_reply_err(request, EIO);
      return;
    }
    file->keep_cache = 1;
    fuse_reply_create(request, &entry, file);
  });
}

void Remove(fuse_req_t request, fuse_ino_t parent, const char* name) {
  WithFaults(request, Operation::kRemove, name, [&](PowerCutDisk& served) {
    const auto number = served.disk.Find(parent, name);
    if (!number) {
      fuse_reply_err(request, ENOENT);
    } else if (served.disk.ShapeOf(*number).is_folder && !served.disk.NamesIn(*number).empty()) {
      fuse_reply_err(request, ENOTEMPTY);
    } else {
      served.disk.Remove(parent, name);
      ReplyToChange(request, "unlink", *number);
    }
  });
}

void Rename(fuse_req_t request, fuse_ino_t parent, const char* name, fuse_ino_t to_parent,
            const char* to_name, unsigned flags) {
  WithFaults(request, Operation::kRename, name, [&](PowerCutDisk& served) {
    const auto number = served.disk.Find(parent, name);
    if (flags != 0 || !number) {
      fuse_reply_err(request, flags != 0 ? EINVAL : ENOENT);
      return;
    }
    served.disk.Rename(parent, name, to_parent, to_name);
    ReplyToChange(request, "rename", *number);
  });
}

void Open(fuse_req_t request, fuse_ino_t number, fuse_file_info* file) {
  const bool writes = (file->flags & O_ACCMODE) != O_RDONLY;
  WithFaults(request, writes ? Operation::kOpenToWrite : Operation::kOpen, Of(request).disk.NameOf(number),
             [&](const PowerCutDisk&) {
               file->keep_cache = 1;
               fuse_reply_open(request, file);
             });
}

void Read(fuse_req_t request, fuse_ino_t number, std::size_t size, off_t offset, fuse_file_info*) {
  WithFaults(request, Operation::kRead, Of(request).disk.NameOf(number), [&](const PowerCutDisk& served) {
    const std::string bytes = served.disk.Read(number, static_cast<std::size_t>(offset), size);
    fuse_reply_buf(request, bytes.data(), bytes.size());
  });
}

// What the kernel writes back of memory that is mapped, SQLite's index of its log, comes whenever it likes:
// not counted.
void Write(fuse_req_t request, fuse_ino_t number, const char* bytes, std::size_t size, off_t offset,
           fuse_file_info* file) {
  const bool is_mapped = file->writepage != 0;
  WithPower(request, [&](PowerCutDisk& served) {
    const int error = is_mapped ? 0 : served.faults.Meet(Operation::kWrite, served.disk.NameOf(number));
    if (error == 0) served.disk.Write(number, static_cast<std::size_t>(offset), {bytes, size});
    if (error != 0) {
      fuse_reply_err(request, error);
    } else if (!is_mapped && served.Count(request, "write", number)) {
      fuse_reply_err(request, EIO);
    } else {
      fuse_reply_write(request, size);
    }
  });
}

void Sync(fuse_req_t request, fuse_ino_t number, int, fuse_file_info*) {
  WithFaults(request, Operation::kSync, Of(request).disk.NameOf(number), [&](PowerCutDisk& served) {
    if (served.Count(request, "sync", number)) {
      fuse_reply_err(request, EIO);
      return;
    }
    if (++served.syncs == served.fail_sync) {
      served.failed_sync = served.disk.NameOf(number);
      served.disk.FailSync(number);
      if (served.cut_after > 0) served.cut_at = served.operations + served.cut_after;
      fuse_reply_err(request, EIO);
      return;
    }
    const bool forgotten = served.forgotten && served.disk.NameOf(number).ends_with(*served.forgotten);
    if (!forgotten) served.disk.Sync(number);
    fuse_reply_err(request, 0);
  });
}

void ReadFolder(fuse_req_t request, fuse_ino_t number, std::size_t size, off_t offset, fuse_file_info*) {
  WithFaults(request, Operation::kList, Of(request).disk.NameOf(number), [&](const PowerCutDisk& served) {
    std::string all;
    off_t next = 0;
    for (const auto& [name, held] : served.disk.NamesIn(number)) {
      if (++next <= offset) continue;
      const struct stat attributes = Attributes(served.disk, held);
      const std::size_t needed = fuse_add_direntry(request, nullptr, 0, name.c_str(), nullptr, 0);
      if (all.size() + needed > size) break;
      const std::size_t at = all.size();
      all.resize(at + needed);
      fuse_add_direntry(request, all.data() + at, needed, name.c_str(), &attributes, next);
    }
    fuse_reply_buf(request, all.data(), all.size());
  });
}

void StatDisk(fuse_req_t request, fuse_ino_t) {
  struct statvfs room {};
  room.f_bsize = room.f_frsize = kBlock_bytes;
  room.f_blocks = room.f_bfree = room.f_bavail = kDisk_blocks;
  room.f_namemax = 255;
  fuse_reply_statfs(request, &room);
}

fuse_lowlevel_ops Operations() {
  fuse_lowlevel_ops operations{};
  operations.init = Init;
  operations.lookup = LookUp;
  operations.getattr = GetAttributes;
  operations.setattr = SetAttributes;
  operations.mkdir = MakeFolder;
  operations.create = Create;
  operations.unlink = Remove;
  operations.rmdir = Remove;
  operations.rename = Rename;
  operations.open = Open;
  operations.read = Read;
  operations.write = Write;
  operations.fsync = Sync;
  operations.fsyncdir = Sync;
  operations.readdir = ReadFolder;
  operations.statfs = StatDisk;
  return operations;
}

int Serve(int argc, char** argv) {
  PowerCutDisk served;
  std::map<std::string, std::string> options;
  for (int i = 3; i < argc; ++i) {
    const std::string option = argv[i];
    options[option.substr(0, option.find('='))] = option.substr(option.find('=') + 1);
  }
  served.folder = argv[1];
  const auto number = [&options](const char* option) {
    return options.contains(option) ? std::stoul(options.at(option)) : 0;
  };
  served.cut_at = number("cut-at");
  served.fail_sync = number("fail-sync");
  served.cut_after = number("cut-after");
  served.faults.fail_at = number("fail-at");
  served.faults.error = static_cast<int>(number("errno"));
  served.faults.lasting = number("lasting") != 0;
  served.faults.write_ms = static_cast<int>(number("write-ms"));
  if (options.contains("only")) served.faults.only = options.at("only");
  std::signal(SIGUSR1, [](int) { FaultPlan::End(); });
  std::signal(SIGUSR2, [](int) { FaultPlan::ChangePace(); });
  if (options.contains("forget")) served.forgotten = options.at("forget");
  served.disk.Seed(number("seed"));
  served.disk.Load(served.folder / "disk");

  const fuse_lowlevel_ops operations = Operations();
  char* arguments[] = {argv[0], nullptr};
  fuse_args args = FUSE_ARGS_INIT(1, arguments);
  fuse_session* const session = fuse_session_new(&args, &operations, sizeof operations, &served);
  if (session == nullptr || fuse_set_signal_handlers(session) != 0 ||
      fuse_session_mount(session, argv[2]) != 0)
    return 1;
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  std::puts("mounted");
  std::fflush(stdout);
  fuse_session_loop(session);
  fuse_session_unmount(session);
  const bool cut = served.off;
  if (!cut) served.Cut();
  std::printf(
      "{\"cut\": %s, \"operations\": %lu, \"syncs\": %lu, \"last_operation\": \"%s\", \"failed_sync\": "
      "\"%s\", \"met\": %lu, \"failed\": \"%s\"}\n",
      cut ? "true" : "false", served.operations, served.syncs, served.last_operation.c_str(),
      served.failed_sync.c_str(), served.faults.met(), served.faults.failed().c_str());
  fuse_remove_signal_handlers(session);
  fuse_session_destroy(session);
  fuse_opt_free_args(&args);
  return 0;
}

}  // namespace
}  // namespace strainwave::power_cuts

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fputs(
        "usage: power_cut_disk FOLDER MOUNTPOINT [cut-at=K] [fail-sync=N [cut-after=J]] [forget=END] "
        "[seed=S] [fail-at=K errno=E [lasting=1] [only=OPERATION]] [write-ms=T]\n",
        stderr);
    return 2;
  }
  try {
    return strainwave::power_cuts::Serve(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "power_cut_disk: error: %s\n", error.what());
    return 3;
  }
}

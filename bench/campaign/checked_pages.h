// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace strainwave::bench {

/// SQLite's access to files (a "VFS") with a checksum in every page of the database file, as
/// `page_checksums.h` says: written with the page, looked at whenever it is read. A page that does not match
/// is SQLITE_IOERR_DATA. Databases without room for checksums are passed through.
enum class Sharing {
  kShared,   // with locks, for files that others may write
  kSettled,  // nobody writes and nothing is written: no lock, no file made, also on a read-only medium
};

/// Name of that access for sqlite3_open_v2; registered with the first call.
const char* CheckedPages(Sharing sharing);

}  // namespace strainwave::bench

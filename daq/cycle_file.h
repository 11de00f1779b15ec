// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "daq/record.h"

/// HDF5 files of several records, such as the raw records of one cycle, `cycles/NNNNNN.h5` (`FORMAT.md`).
namespace strainwave::daq {

/// Whether what is read must keep the rules of `record_rules.h`, or their bounds alone (a sensor that died is
/// part of the raw record).
enum class Checking { kRules, kNone };

/// Whether values that become at most four fifths of their size are stored shuffled and deflated, which every
/// HDF5 reads without a plug-in. The bits are the same.
enum class Packing { kPlain, kDeflated };

/// Names and texts in order; a text that is a number in its shortest form is stored as a number.
using Attributes = std::vector<std::pair<std::string, std::string>>;

struct NamedRecord {
  std::string group;  // "hysteresis", "repeat/2/hysteresis"; a leading slash is allowed
  Record record;
};

struct CycleFile {
  Attributes attributes;
  std::vector<NamedRecord> records;  // in the order written; `group` with its leading slash
};

/// What HDF5 sets up at its first use. It crashes where it gets no memory for that: to be called before
/// anything moves.
void SetUpHdf5();

/// With the version of the format before them, as every file of records says it.
Attributes WithFormat(const Attributes& attributes);

/// The bytes of a file of these records, of which `path` is told in errors alone. Values are not judged, so
/// that whatever was measured can be stored. The same arguments give the same bytes.
/// @throws std::invalid_argument if there is no record, two have one group, or one cannot be written (see
///   `WriteRecordGroup`); DataFileError with the path when HDF5 cannot build it.
std::vector<std::byte> ImageOfRecords(std::span<const NamedRecord> records, const Attributes& attributes,
                                      const std::filesystem::path& path, Packing packing);

/// Writes that file, plain, so that it appears whole or not at all, also after a power cut.
/// @throws as `ImageOfRecords`; DataFileError with the path and the errno of the step that failed.
void WriteRecordsAtomically(const std::filesystem::path& path, std::span<const NamedRecord> records,
                            const Attributes& attributes = {});

/// Reads every record of a file, and the attributes of the file itself.
/// @param columns  of each record no others are read, these without sensor and calibration; a record within
///   another is not looked for, and with `Checking::kNone` no column is missed. Empty: all.
/// @throws RecordError with the findings of all records: a missing or cut file, a foreign one without a
///   record, a checksum that does not match, and with `Checking::kRules` what breaks the rules.
CycleFile ReadCycleFile(const std::filesystem::path& path, Checking checking = Checking::kRules,
                        std::span<const std::string_view> columns = {});

}  // namespace strainwave::daq

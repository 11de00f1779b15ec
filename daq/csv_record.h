// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "daq/record.h"

namespace strainwave::daq {

/// Reads one record from CSV (docs/contract.md#record-files): lines `# key: value`, one header line, numbers;
/// in the forms that `csv_form.h` understands as well. A UTF-8 byte order mark, CR LF, blanks around cells, a
/// plus sign, and blank lines at the end are taken as they come. Columns of text that the kind does not know
/// are left out, which `Record::notes` says. Numbers become doubles.
/// @throws RecordError with every finding as `FILE:LINE:COLUMN: error: WHAT (expected ...)`; the column
///   counts bytes from 1. A file that is missing, a folder or unreadable has no line and column.
Record ReadCsvRecord(const std::filesystem::path& path);

/// The same for a text in memory; `file` is its name for messages.
Record ParseCsvRecord(std::string_view text, const std::string& file);

/// The record as CSV, numbers in the shortest text that reads back to the same bits.
/// @throws std::invalid_argument if columns differ in length, or a name, key or value cannot be told apart
///   again when read (a line end; blanks at its ends; a comma or a quote in a name; a colon in a key; a name
///   twice).
std::string CsvTextOf(const Record& record);

/// Writes `CsvTextOf(record)`; the file appears whole or not at all.
/// @throws std::invalid_argument as above; DataFileError.
void WriteCsvRecord(const Record& record, const std::filesystem::path& path);

}  // namespace strainwave::daq

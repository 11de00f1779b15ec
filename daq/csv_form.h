// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <utility>

/// In which form a CSV file is written: spreadsheets, NumPy and loggers do not agree on the signs.
namespace strainwave::daq {

/// A CSV text with decimal points and its column names in a line of their own. A view of the text that it was
/// made from where nothing had to be changed.
class CsvForm {
 public:
  CsvForm(char separator, std::string_view original, std::string changed)
      : separator_(separator), original_(original), changed_(std::move(changed)) {}
  char separator() const { return separator_; }
  std::string_view text() const { return changed_.empty() ? original_ : std::string_view(changed_); }

 private:
  char separator_;
  std::string_view original_;
  std::string changed_;
};

/// Brings `text` into that form; a byte order mark goes. Every line and every byte column keeps its number,
/// so that messages are right for the file as it is. Understood besides docs/contract.md#record-files:
///  - semicolons, tabs, bars or blanks between the cells, told from the names in the header, or by a first
///  line `sep=;`;
///  - decimal commas, where the cells are not separated by commas, or stand in quotes;
///  - the header behind `#`, as NumPy's savetxt writes it, where only numbers follow the lines with `#`;
///  - lines of metadata that a spreadsheet has put in quotes, or filled up with separators.
/// @throws RecordError with the one cause where the text is not UTF-8, a number could be read in two ways
/// (decimal commas between commas;
///   commas and points; `1,500`), a line `sep=` contradicts the header, or there is no header.
CsvForm PlainCsvForm(std::string_view text, const std::string& file);

}  // namespace strainwave::daq

// SPDX-License-Identifier: Apache-2.0
#include "daq/import/write_foreign.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <memory>
#include <optional>
#include <stdexcept>
#include <vector>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "daq/data_file_error.h"
#include "daq/import/mat_handles.h"
#include "daq/record_rules.h"
#include "daq/value_bounds.h"
#include "daq/whole_file.h"

namespace strainwave::daq {
namespace {

std::vector<double> NumbersOf(const Record& record, const Column& column) {
  if (const auto* directions = std::get_if<std::vector<Direction>>(&column.values)) {
    std::vector<double> numbers;
    for (const Direction direction : *directions) numbers.push_back(static_cast<double>(direction));
    return numbers;
  }
  return record.CopyAsDoubles(column.name);
}

// A letter first, then letters, digits and underscores; 63 at most.
std::string MatName(const std::string& name) {
  std::string plain;
  for (const char c : name) plain += std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
  if (plain.empty() || std::isalpha(static_cast<unsigned char>(plain.front())) == 0) plain = "x" + plain;
  return plain.substr(0, 63);
}

void Put(mat_t* file, matvar_t* variable, const std::filesystem::path& path) {
  const MatVariable owned(variable);
  if (!owned || Mat_VarWrite(file, owned.get(), MAT_COMPRESSION_NONE) != 0)
    throw DataFileError(std::error_code(EIO, std::generic_category()), "cannot write", path.string());
}

void PutText(mat_t* file, const std::string& name, std::string text, const std::filesystem::path& path) {
  std::size_t dims[2] = {1, text.size()};
  Put(file, Mat_VarCreate(name.c_str(), MAT_C_CHAR, MAT_T_UTF8, 2, dims, text.data(), 0), path);
}

// The step of time where all steps are alike to a thousandth of one.
std::optional<double> EvenStep_s(const std::vector<double>& time_s) {
  if (time_s.size() < 2) return std::nullopt;
  const double step_s = (time_s.back() - time_s.front()) / static_cast<double>(time_s.size() - 1);
  if (!(step_s > 0.0)) return std::nullopt;
  constexpr double kEven = 1e-3;
  for (std::size_t i = 0; i < time_s.size(); ++i) {
    if (std::abs(time_s[i] - time_s.front() - static_cast<double>(i) * step_s) > kEven * step_s)
      return std::nullopt;
  }
  return step_s;
}

struct Abscissa {
  std::vector<double> uneven_s;
  double first_s{};
  double step_s{};
};

Abscissa AbscissaOf(const Record& record) {
  Abscissa abscissa;
  if (record.FindColumn("time_s") != nullptr) {
    const std::vector<double> time_s = record.CopyAsDoubles("time_s");
    if (const std::optional<double> step_s = EvenStep_s(time_s)) {
      abscissa.first_s = time_s.front();
      abscissa.step_s = *step_s;
    } else {
      abscissa.uneven_s = time_s;
    }
    return abscissa;
  }
  const std::optional<double> rate_hz = MetadataNumber(record, "sample_rate_hz");
  if (!rate_hz)
    throw std::invalid_argument("a record without time_s or sample_rate_hz cannot be a function of time");
  abscissa.step_s = 1.0 / *rate_hz;
  return abscissa;
}

// What a unit measures, by the numbers of data set 58.
int QuantityOf(const std::string& unit) {
  if (unit == "m/s^2" || unit == "g") return 12;
  if (unit == "m/s" || unit == "rad/s" || unit == "deg/s") return 11;
  if (unit == "m" || unit == "mm" || unit == "rad" || unit == "deg") return 8;
  if (unit == "N") return 9;
  if (unit == "degC") return 5;
  return 0;
}

std::string Cut(std::string text) {
  std::ranges::replace(text, '\n', ' ');
  return text.substr(0, 80);
}

std::string FunctionOf(const Record& record, const Column& column, const Abscissa& abscissa, int number) {
  const std::vector<double> values = NumbersOf(record, column);
  const std::string unit = UnitOf(column.name);
  const bool even = abscissa.uneven_s.empty();
  std::string metadata;
  for (const auto& [key, value] : record.metadata)
    metadata += fmt::format("{}{}={}", metadata.empty() ? "" : "; ", key, value);
  std::string text = "    -1\n    58\n";
  text += fmt::format("{:<80}\n{:<80}\n{:<80}\n{:<80}\n{:<80}\n", Cut(column.name),
                      Cut(fmt::format("kind={}", record.kind.name())), "NONE",
                      Cut(metadata.empty() ? "NONE" : metadata), "NONE");
  text += fmt::format("{:5d}{:10d}{:5d}{:10d} {:<10}{:10d}{:4d} {:<10}{:10d}{:4d}\n", 1, number, 0, 0, "NONE",
                      number, 0, "NONE", 0, 0);
  text += fmt::format("{:10d}{:10d}{:10d}{:13.5E}{:13.5E}{:13.5E}\n", 4, values.size(), even ? 1 : 0,
                      abscissa.first_s, abscissa.step_s, 0.0);
  const auto axis = [&](int quantity, std::string_view label, const std::string& axis_unit) {
    text += fmt::format("{:10d}{:5d}{:5d}{:5d} {:<20} {:<20}\n", quantity, 0, 0, 0, label,
                        axis_unit.empty() ? "NONE" : axis_unit);
  };
  axis(17, "time", "s");
  axis(QuantityOf(unit), column.name.substr(0, 20), unit);
  axis(0, "NONE", "");
  axis(0, "NONE", "");
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!even) text += fmt::format("{:13.5E}", abscissa.uneven_s[i]);
    text += fmt::format("{:20.11E}", values[i]);
    const std::size_t together = even ? 4 : 2;
    if ((i + 1) % together == 0 || i + 1 == values.size()) text += '\n';
  }
  return text + "    -1\n";
}

}  // namespace

void WriteMatFile(const Record& record, const std::filesystem::path& path) {
  const std::filesystem::path partial = path.parent_path() / ("." + path.filename().string() + ".partial");
  {
    const MatHandle file(
        Mat_CreateVer(partial.c_str(), "MATLAB 5.0 MAT-file, written by strainwave", MAT_FT_MAT5));
    if (!file) throw DataFileError(LastError(), "cannot write", partial.string());
    PutText(file.get(), "kind", std::string(record.kind.name()), partial);
    for (const auto& [key, value] : record.metadata) {
      if (std::optional<double> number = NumberFromText(value)) {
        std::size_t one[2] = {1, 1};
        Put(file.get(), Mat_VarCreate(MatName(key).c_str(), MAT_C_DOUBLE, MAT_T_DOUBLE, 2, one, &*number, 0),
            partial);
      } else {
        PutText(file.get(), MatName(key), value, partial);
      }
    }
    for (const Column& column : record.columns) {
      std::vector<double> values = NumbersOf(record, column);
      std::size_t dims[2] = {values.size(), 1};
      Put(file.get(),
          Mat_VarCreate(MatName(column.name).c_str(), MAT_C_DOUBLE, MAT_T_DOUBLE, 2, dims, values.data(),
                        MAT_F_DONT_COPY_DATA),
          partial);
    }
  }
  const std::string bytes = ReadWholeFile(partial);
  WriteFileAtomically(path, bytes);
  std::error_code none;
  std::filesystem::remove(partial, none);
}

std::string UffTextOf(std::span<const Record> records) {
  std::string text;
  int number = 0;
  for (const Record& record : records) {
    const Abscissa abscissa = AbscissaOf(record);
    for (const Column& column : record.columns) {
      if (column.name != "time_s") text += FunctionOf(record, column, abscissa, ++number);
    }
  }
  return text;
}

}  // namespace strainwave::daq

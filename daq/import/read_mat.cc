// SPDX-License-Identifier: Apache-2.0

#include <cstdint>
#include <fstream>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "daq/import/foreign_file.h"
#include "daq/import/mat_handles.h"
#include "daq/large_memory.h"
#include "daq/record.h"
#include "daq/record_error.h"
#include "daq/record_limits.h"

namespace strainwave::daq {
namespace {

// Of a level-5 file: the library says nothing of a variable that the file ends in.
void CheckLength(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  constexpr std::uint64_t kHeader_bytes = 128;
  constexpr std::uint64_t kTag_bytes = 8;
  constexpr std::uint32_t kCompressed = 15;
  const std::uint64_t size = std::filesystem::file_size(path);
  std::array<char, kHeader_bytes> header{};
  file.read(header.data(), header.size());
  const bool swapped =
      std::string_view(header.data() + 126, 2) == "MI";  // written the other way round: big-endian
  const auto word = [swapped](const unsigned char* b) {
    const std::uint32_t little = b[0] | b[1] << 8U | b[2] << 16U | static_cast<std::uint32_t>(b[3]) << 24U;
    return swapped ? __builtin_bswap32(little) : little;
  };
  std::size_t whole = 0;
  for (std::uint64_t at = kHeader_bytes; at < size;) {
    std::array<unsigned char, kTag_bytes> tag{};
    file.seekg(static_cast<std::streamoff>(at));
    file.read(reinterpret_cast<char*>(tag.data()), tag.size());
    const std::uint64_t bytes = word(tag.data() + 4);
    if (!file || at + kTag_bytes + bytes > size)
      throw RecordError(fmt::format("{}: byte {}", path.string(), at),
                        fmt::format("the file is cut off within variable {}; {} before it {} whole",
                                    whole + 1, whole, whole == 1 ? "is" : "are"),
                        fmt::format("{} bytes more", file ? at + kTag_bytes + bytes - size : kTag_bytes));
    ++whole;
    const std::uint64_t padded = word(tag.data()) == kCompressed ? bytes : (bytes + 7) / 8 * 8;
    at += kTag_bytes + padded;
  }
}

bool IsNumeric(const matvar_t& variable) {
  switch (variable.class_type) {
    case MAT_C_DOUBLE:
    case MAT_C_SINGLE:
    case MAT_C_INT8:
    case MAT_C_UINT8:
    case MAT_C_INT16:
    case MAT_C_UINT16:
    case MAT_C_INT32:
    case MAT_C_UINT32:
    case MAT_C_INT64:
    case MAT_C_UINT64:
      return true;
    default:
      return false;
  }
}

template <typename Number>
void Copy(const void* data, std::size_t first, std::size_t step, std::vector<double>& out) {
  const auto* const numbers = static_cast<const Number*>(data);
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = static_cast<double>(numbers[first + i * step]);
}

// Values first, first + step, ... of an array of numbers.
std::vector<double> Values(const matvar_t& variable, std::size_t first, std::size_t step, std::size_t count) {
  std::vector<double> out(count);
  const void* const data = variable.data;
  switch (variable.class_type) {
    case MAT_C_DOUBLE:
      Copy<double>(data, first, step, out);
      break;
    case MAT_C_SINGLE:
      Copy<float>(data, first, step, out);
      break;
    case MAT_C_INT8:
      Copy<std::int8_t>(data, first, step, out);
      break;
    case MAT_C_UINT8:
      Copy<std::uint8_t>(data, first, step, out);
      break;
    case MAT_C_INT16:
      Copy<std::int16_t>(data, first, step, out);
      break;
    case MAT_C_UINT16:
      Copy<std::uint16_t>(data, first, step, out);
      break;
    case MAT_C_INT32:
      Copy<std::int32_t>(data, first, step, out);
      break;
    case MAT_C_UINT32:
      Copy<std::uint32_t>(data, first, step, out);
      break;
    case MAT_C_INT64:
      Copy<std::int64_t>(data, first, step, out);
      break;
    default:
      Copy<std::uint64_t>(data, first, step, out);
      break;
  }
  return out;
}

std::string TextOf(const matvar_t& variable) {
  std::string text;
  std::size_t count = 1;
  for (int d = 0; d < variable.rank; ++d) count *= variable.dims[d];
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t letter = variable.data_size == 2 ? static_cast<const std::uint16_t*>(variable.data)[i]
                                                         : static_cast<const std::uint8_t*>(variable.data)[i];
    text += letter < 0x80 ? static_cast<char>(letter) : '?';
  }
  return text;
}

class MatReader {
 public:
  explicit MatReader(const std::filesystem::path& path) : path_(path) {}

  ForeignFile Read(ForeignFormat format) {
    if (format == ForeignFormat::kMat5) CheckLength(path_);
    const MatHandle mat(Mat_Open(path_.c_str(), MAT_ACC_RDONLY));
    if (!mat) throw RecordError(path_.string(), "cannot be read as a MAT file", "MAT 5 or 7.3");
    file_.format = NameOf(format);
    // Before any data: matio goes on from where it last read, and a vector that is read straight into its
    // series leaves it there.
    std::vector<MatVariable> variables;
    while (MatVariable variable{Mat_VarReadNextInfo(mat.get())}) variables.push_back(std::move(variable));
    for (MatVariable& variable : variables) {
      const std::string name = variable->name == nullptr ? "" : variable->name;
      const std::size_t count = CountOf(*variable);
      if (count > kMostValues - values_)
        throw RecordError(path_.string(), fmt::format("variable {} has {} values", name, count),
                          fmt::format("{} in the file at most", kMostValues));
      if (!IsNumeric(*variable) && variable->class_type != MAT_C_STRUCT &&
          variable->class_type != MAT_C_CHAR) {
        LeaveOut(name, *variable);
        continue;
      }
      values_ += count;
      if (IsPlainVector(*variable)) {
        ReadVector(mat.get(), name, *variable, count);
        continue;
      }
      if (Mat_VarReadDataAll(mat.get(), variable.get()) != 0)
        throw RecordError(path_.string(), fmt::format("variable {} cannot be read", name),
                          fmt::format("a whole file; before it {} series are whole", file_.channels.size()));
      Take(name, *variable, 0);
      variable.reset();
    }
    return std::move(file_);
  }

 private:
  static std::size_t CountOf(const matvar_t& variable) {
    std::size_t count = 1;
    for (int d = 0; d < variable.rank; ++d) {
      if (variable.dims[d] != 0 && count > kMostValues / variable.dims[d]) return kMostValues + 1;
      count *= variable.dims[d];
    }
    return count;
  }

  // What long series are, as a rule; needs no memory but its own.
  static bool IsPlainVector(const matvar_t& variable) {
    return variable.class_type == MAT_C_DOUBLE && variable.isComplex == 0 && variable.rank == 2 &&
           (variable.dims[0] == 1 || variable.dims[1] == 1) && variable.dims[0] * variable.dims[1] > 1;
  }

  void ReadVector(mat_t* mat, const std::string& name, matvar_t& variable, std::size_t count) {
    ForeignChannel channel{.name = name, .unit = {}, .values = {}, .words = {}};
    ReserveLarge(channel.values, count);
    channel.values.resize(count);
    if (Mat_VarReadDataLinear(mat, &variable, channel.values.data(), 0, 1, static_cast<int>(count)) != 0)
      throw RecordError(path_.string(), fmt::format("variable {} cannot be read", name),
                        fmt::format("a whole file; before it {} series are whole", file_.channels.size()));
    file_.channels.push_back(std::move(channel));
  }

  void LeaveOut(const std::string& name, const matvar_t& variable) {
    const char* what = "of a class that is not read";
    if (variable.class_type == MAT_C_CELL) what = "a cell array";
    if (variable.class_type == MAT_C_SPARSE) what = "a sparse matrix";
    if (variable.class_type == MAT_C_OBJECT || variable.class_type == MAT_C_OPAQUE) what = "an object";
    if (variable.class_type == MAT_C_FUNCTION) what = "a function";
    file_.notes.push_back(fmt::format("variable {} is left out: it is {}", name, what));
  }

  void Take(const std::string& name, const matvar_t& variable, int depth) {
    if (variable.class_type == MAT_C_STRUCT) return TakeStruct(name, variable, depth);
    if (variable.data == nullptr && CountOf(variable) > 0) return LeaveOut(name, variable);
    if (variable.class_type == MAT_C_CHAR) {
      file_.metadata.emplace_back(name, TextOf(variable));
      return;
    }
    if (!IsNumeric(variable)) return LeaveOut(name, variable);
    if (variable.isComplex != 0) {
      file_.notes.push_back(fmt::format("variable {} is left out: its numbers are complex", name));
      return;
    }
    if (variable.rank != 2) {
      file_.notes.push_back(
          fmt::format("variable {} is left out: it has {} dimensions", name, variable.rank));
      return;
    }
    TakeMatrix(name, variable);
  }

  void TakeStruct(const std::string& name, const matvar_t& variable, int depth) {
    if (depth > 0 || CountOf(variable) != 1) {
      file_.notes.push_back(fmt::format("variable {} is left out: it is {}", name,
                                        depth > 0 ? "a struct in a struct" : "an array of structs"));
      return;
    }
    const unsigned fields = Mat_VarGetNumberOfFields(const_cast<matvar_t*>(&variable));
    char* const* names = Mat_VarGetStructFieldnames(&variable);
    for (unsigned f = 0; f < fields; ++f) {
      const matvar_t* const field = Mat_VarGetStructFieldByIndex(const_cast<matvar_t*>(&variable), f, 0);
      if (field != nullptr) Take(fmt::format("{}.{}", name, names[f]), *field, depth + 1);
    }
  }

  // One series a column, or a row where there are fewer rows than columns.
  void TakeMatrix(const std::string& name, const matvar_t& variable) {
    const std::size_t rows = variable.dims[0];
    const std::size_t columns = variable.dims[1];
    if (rows == 0 || columns == 0) {
      file_.notes.push_back(fmt::format("variable {} is left out: it is empty", name));
    } else if (rows == 1 && columns == 1) {
      file_.metadata.emplace_back(name, ShortestText(Values(variable, 0, 1, 1).front()));
    } else if (rows == 1 || columns == 1) {
      file_.channels.push_back(
          {.name = name, .unit = {}, .values = Values(variable, 0, 1, rows * columns), .words = {}});
    } else if (rows >= columns) {
      for (std::size_t c = 0; c < columns; ++c)
        file_.channels.push_back({.name = fmt::format("{}(:,{})", name, c + 1),
                                  .unit = {},
                                  .values = Values(variable, c * rows, 1, rows),
                                  .words = {}});
    } else {
      for (std::size_t r = 0; r < rows; ++r)
        file_.channels.push_back({.name = fmt::format("{}({},:)", name, r + 1),
                                  .unit = {},
                                  .values = Values(variable, r, rows, columns),
                                  .words = {}});
    }
  }

  const std::filesystem::path& path_;
  ForeignFile file_;
  std::size_t values_{};
};

}  // namespace

ForeignFile ReadMatFile(const std::filesystem::path& path) {
  Mat_LogInitFunc("strainwave", [](int, char*) {});  // what it says goes to standard error otherwise
  return MatReader(path).Read(ForeignFormatOf(path));
}

}  // namespace strainwave::daq

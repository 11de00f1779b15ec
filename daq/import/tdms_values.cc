// SPDX-License-Identifier: Apache-2.0
#include "daq/import/tdms_values.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <iterator>
#include <stdexcept>

#include "daq/import/tdms_types.h"

namespace strainwave::daq::tdms {
namespace {

template <typename Number, bool kSwapped>
Number NumberAt(const char* at) {
  std::array<char, sizeof(Number)> raw;
  std::memcpy(raw.data(), at, raw.size());
  if constexpr (kSwapped) std::ranges::reverse(raw);
  return std::bit_cast<Number>(raw);
}

template <typename Number, bool kSwapped>
struct Plain {
  static constexpr std::size_t kWidth = sizeof(Number);
  static double At(const char* at) { return static_cast<double>(NumberAt<Number, kSwapped>(at)); }
};

// Seconds since 1904, and 2⁻⁶⁴ of one before them; behind them where the order of bytes is the other one.
template <bool kSwapped>
struct Time {
  static double At(const char* at) {
    const auto fraction = NumberAt<std::uint64_t, kSwapped>(at + (kSwapped ? 8 : 0));
    const auto seconds = NumberAt<std::int64_t, kSwapped>(at + (kSwapped ? 0 : 8));
    return static_cast<double>(seconds) + std::ldexp(static_cast<double>(fraction), -64);
  }
};

// By which a vector takes the numbers without having been filled with zeros before.
template <typename Form>
class Iterator {
 public:
  using iterator_category = std::random_access_iterator_tag;
  using value_type = double;
  using difference_type = std::ptrdiff_t;
  using pointer = const double*;
  using reference = double;

  Iterator(const char* first, std::size_t stride, std::size_t number)
      : first_(first), stride_(stride), number_(number) {}

  double operator*() const { return Form::At(first_ + number_ * stride_); }
  Iterator& operator++() {
    ++number_;
    return *this;
  }
  Iterator& operator--() {
    --number_;
    return *this;
  }
  Iterator& operator+=(difference_type by) {
    number_ += static_cast<std::size_t>(by);
    return *this;
  }
  difference_type operator-(const Iterator& other) const {
    return static_cast<difference_type>(number_) - static_cast<difference_type>(other.number_);
  }
  bool operator==(const Iterator& other) const { return number_ == other.number_; }

 private:
  const char* first_;
  std::size_t stride_;
  std::size_t number_;
};

template <typename Form>
void Append(const char* first, std::size_t stride, std::size_t count, std::vector<double>& values) {
  values.insert(values.end(), Iterator<Form>(first, stride, 0), Iterator<Form>(first, stride, count));
}

template <bool kSwapped>
void AppendInOrder(std::uint32_t type, const char* first, std::size_t stride, std::size_t count,
                   std::vector<double>& values) {
  switch (type) {
    case kInt8:
      return Append<Plain<std::int8_t, kSwapped>>(first, stride, count, values);
    case kInt16:
      return Append<Plain<std::int16_t, kSwapped>>(first, stride, count, values);
    case kInt32:
      return Append<Plain<std::int32_t, kSwapped>>(first, stride, count, values);
    case kInt64:
      return Append<Plain<std::int64_t, kSwapped>>(first, stride, count, values);
    case kUint8:
    case kBoolean:
      return Append<Plain<std::uint8_t, kSwapped>>(first, stride, count, values);
    case kUint16:
      return Append<Plain<std::uint16_t, kSwapped>>(first, stride, count, values);
    case kUint32:
      return Append<Plain<std::uint32_t, kSwapped>>(first, stride, count, values);
    case kUint64:
      return Append<Plain<std::uint64_t, kSwapped>>(first, stride, count, values);
    case kSingle:
    case kSingleWithUnit:
      return Append<Plain<float, kSwapped>>(first, stride, count, values);
    case kDouble:
    case kDoubleWithUnit:
      return Append<Plain<double, kSwapped>>(first, stride, count, values);
    case kTimeStamp:
      return Append<Time<kSwapped>>(first, stride, count, values);
    default:
      throw std::invalid_argument("type of a number without a width");
  }
}

}  // namespace

void AppendNumbers(std::uint32_t type, bool big_endian, const char* first, std::size_t stride,
                   std::size_t count, std::vector<double>& values) {
  if (big_endian == (std::endian::native == std::endian::big)) {
    AppendInOrder<false>(type, first, stride, count, values);
  } else {
    AppendInOrder<true>(type, first, stride, count, values);
  }
}

}  // namespace strainwave::daq::tdms

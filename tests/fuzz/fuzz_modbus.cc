// SPDX-License-Identifier: Apache-2.0
// Any answer to any request, any registers of any type, and any map.
#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

#include "protocols/modbus/pdu.h"
#include "protocols/modbus/read_plan.h"
#include "protocols/modbus/register_codec.h"

namespace {

using namespace strainwave::protocols::modbus;

// Bytes of the input, one after the other; zeros when there are no more.
class Bytes {
 public:
  explicit Bytes(std::span<const std::uint8_t> data) : data_(data) {}
  std::uint8_t Next() {
    if (data_.empty()) return 0;
    const std::uint8_t byte = data_[0];
    data_ = data_.subspan(1);
    return byte;
  }
  std::uint16_t Word() {
    const int high = Next();
    return static_cast<std::uint16_t>(high << 8 | Next());
  }
  bool empty() const { return data_.empty(); }
  std::span<const std::uint8_t> rest() const { return data_; }

 private:
  std::span<const std::uint8_t> data_;
};

Register AnyRegister(Bytes& bytes) {
  Register value;
  const std::uint8_t kinds = bytes.Next(), orders = bytes.Next();
  value.name = std::to_string(bytes.Next());
  value.table = static_cast<Table>(kinds & 3);
  value.type = static_cast<ValueType>((kinds >> 2) % 6);
  value.word_order = static_cast<WordOrder>(orders & 1);
  value.byte_order = static_cast<ByteOrder>(orders >> 1 & 1);
  value.access = static_cast<Access>((orders >> 2) % 3);
  value.address = bytes.Word();
  return value;
}

void TakeAnyAnswer(Bytes bytes) {
  const auto table = static_cast<Table>(bytes.Next() & 3);
  const std::uint16_t first = bytes.Next();
  const std::uint16_t count = static_cast<std::uint16_t>(1 + bytes.Next() % 125);
  std::vector<std::uint16_t> words(count, 0xA5A5);
  const Answer answer = TakeAnswer(ReadPdu(table, first, count), bytes.rest(), words);
  for (const std::uint16_t word : words) {
    if (answer.kind != AnswerKind::kGood && word != 0xA5A5) std::abort();
  }
  TakeMbap(bytes.rest());
}

void CodeThereAndBack(Bytes bytes) {
  const Register value = AnyRegister(bytes);
  std::uint16_t words[] = {bytes.Word(), bytes.Word()};
  if (value.type == ValueType::kBit) words[0] &= 1;
  const auto length = static_cast<std::size_t>(Length(value.type));
  const Decoded decoded = Decode(value, std::span(words).first(length));
  if (decoded.problem != CodecProblem::kNone) return;
  const Encoded encoded = Encode(value, decoded.value);
  if (encoded.problem != CodecProblem::kNone) std::abort();
  const Decoded again = Decode(value, encoded.span());
  if (again.value != decoded.value) std::abort();
}

void PlanAnyMap(Bytes bytes) {
  RegisterMap map;
  map.read_gap = bytes.Next() % 16;
  map.most_registers = 2 + bytes.Next() % 124;
  std::vector<std::size_t> wanted;
  while (!bytes.empty() && map.registers.size() < 64) {
    map.registers.push_back(AnyRegister(bytes));
    if (CanRead(map.registers.back())) wanted.push_back(map.registers.size() - 1);
  }
  if (!CheckMap(map).empty()) return;
  std::size_t brought = 0;
  for (const ReadRequest& request : PlanReads(map, wanted)) {
    ReadPdu(request.table, request.first, request.count);  // throws for one that no frame can ask for
    for (const std::size_t index : request.registers) {
      const Register& value = map.registers[index];
      const int end = value.address + Length(value.type);
      if (value.table != request.table || value.address < request.first ||
          end > request.first + request.count) {
        std::abort();
      }
      ++brought;
    }
  }
  if (brought != wanted.size()) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const Bytes bytes(std::span(data, size));
  TakeAnyAnswer(bytes);
  CodeThereAndBack(bytes);
  PlanAnyMap(bytes);
  return 0;
}

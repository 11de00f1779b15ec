// SPDX-License-Identifier: Apache-2.0
#include "bench/devices/modbus/modbus_link.h"

#include <system_error>
#include <utility>

namespace strainwave::bench {

using protocols::modbus::Pdu;

ModbusLink::ModbusLink(ModbusSettings settings, const Wake* wake)
    : settings_(std::move(settings)), wake_(wake), transport_(MakeTransport(settings_, counts_)) {}

ModbusReply ModbusLink::Ask(const Pdu& pdu, std::span<std::uint16_t> words, const Wake* wake) {
  ModbusReply reply;
  for (int asked = 0; asked <= settings_.retries; ++asked) {
    reply = transport_->Ask(pdu, words, wake);
    switch (reply.outcome) {
      case ModbusReply::Outcome::kGood:
      case ModbusReply::Outcome::kException:
      case ModbusReply::Outcome::kInterrupted:
      case ModbusReply::Outcome::kDisconnected:
        return reply;
      case ModbusReply::Outcome::kTimeout:
      case ModbusReply::Outcome::kWrongAnswer:
        break;
    }
    if (!is_open()) return reply;
  }
  Close();
  return reply;
}

ModbusReply ModbusLink::Read(const protocols::modbus::ReadRequest& request, std::span<std::uint16_t> words) {
  return Ask(protocols::modbus::ReadPdu(request.table, request.first, request.count), words, wake_);
}

ModbusReply ModbusLink::Write(const protocols::modbus::WriteRequest& request) {
  return Ask(protocols::modbus::WritePdu(request.table, request.first, request.words), {}, nullptr);
}

ModbusReply ModbusLink::Write(std::span<const protocols::modbus::WriteRequest> requests) {
  for (const auto& request : requests) {
    if (const ModbusReply reply = Write(request); !reply.good()) return reply;
  }
  return {};
}

ModbusReply ModbusLink::WriteEach(std::span<const protocols::modbus::WriteRequest> requests) {
  ModbusReply worst;
  bool was_lost = false;
  for (int asked = 0; asked <= settings_.retries; ++asked) {
    worst = {};
    for (const auto& request : requests) {
      if (!is_open()) {
        was_lost = true;
        try {
          Open();
        } catch (const std::system_error&) {
          return {ModbusReply::Outcome::kDisconnected};
        }
      }
      const Pdu pdu = protocols::modbus::WritePdu(request.table, request.first, request.words);
      if (const ModbusReply reply = transport_->Ask(pdu, {}, nullptr); !reply.good()) worst = reply;
    }
    if (worst.good() || worst.outcome == ModbusReply::Outcome::kException) break;
  }
  const bool answered = worst.good() || worst.outcome == ModbusReply::Outcome::kException;
  if (was_lost || !answered) Close();
  return worst;
}

ModbusReply ModbusLink::WriteUnlessCalled(std::span<const protocols::modbus::WriteRequest> requests) {
  for (const auto& request : requests) {
    const Pdu pdu = protocols::modbus::WritePdu(request.table, request.first, request.words);
    if (const ModbusReply reply = Ask(pdu, {}, wake_); !reply.good()) return reply;
  }
  return {};
}

}  // namespace strainwave::bench

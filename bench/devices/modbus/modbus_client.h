// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <map>
#include <mutex>
#include <string>
#include <thread>

#include "bench/devices/modbus/modbus_link.h"
#include "bench/devices/modbus/modbus_poller.h"
#include "bench/devices/wake.h"
#include "bench/roles/bench_clock.h"
#include "bench/roles/channel_value.h"

namespace strainwave::bench {

/// What a client does besides reading. All of it is called from the client's thread.
class ModbusDuties {
 public:
  ModbusDuties() = default;
  ModbusDuties(const ModbusDuties&) = delete;
  ModbusDuties& operator=(const ModbusDuties&) = delete;
  virtual ~ModbusDuties() = default;

  /// How often `Write` is called; above zero.
  virtual std::chrono::nanoseconds WritePeriod() const = 0;
  /// After each connection, before anything is read.
  virtual ModbusReply Connected(ModbusLink& link, ModbusPoller& poller) = 0;
  /// Every period, and at once when the client was woken.
  virtual ModbusReply Write(ModbusLink& link) = 0;
  /// After the connection was lost.
  virtual void Lost() noexcept = 0;
  /// The last word to the device, while there is a connection.
  virtual void Leave(ModbusLink& link) = 0;
};

/// One device on Modbus, served from a thread of its own, so that nobody else ever waits for it. Connects
/// again by itself, each time after a longer pause.
class ModbusClient {
 public:
  /// @param duties  null: it is only read. They and the clock outlive the client.
  /// @throws std::invalid_argument for a map with problems; the message names them all.
  ModbusClient(ModbusSettings settings, protocols::modbus::RegisterMap map, const BenchClock& clock,
               ModbusDuties* duties = nullptr);
  ModbusClient(const ModbusClient&) = delete;
  ModbusClient& operator=(const ModbusClient&) = delete;
  /// Leaves the device as its duties say, and closes.
  ~ModbusClient();

  /// Of a register by its position in the map. Never waits.
  ChannelValue Value(std::size_t index) const noexcept { return poller_.Value(index); }
  /// Has the duties written at once. Never waits.
  void Call() noexcept { wake_.Call(); }
  bool connected() const noexcept { return connected_; }

  /// What is wrong now, in words, a line each; empty while all is well. Not for the control thread.
  std::string trouble() const;
  const ModbusCounts& counts() const { return link_.counts(); }
  const protocols::modbus::RegisterMap& map() const { return map_; }

 private:
  void Run();
  bool Connect();
  ModbusReply OneRound(std::chrono::nanoseconds& next_write);
  void Pause(std::chrono::nanoseconds time);
  void Note(const std::string& asked, const ModbusReply& reply);
  void NoteText(const std::string& asked, const std::string& text);

  const protocols::modbus::RegisterMap map_;
  const BenchClock& clock_;
  ModbusDuties* const duties_;
  Wake wake_;
  ModbusLink link_;
  ModbusPoller poller_;
  std::atomic<bool> stop_{false};
  std::atomic<bool> connected_{false};
  mutable std::mutex trouble_mutex_;
  std::map<std::string, std::string> trouble_;  // what was asked, why it did not come
  std::thread thread_;
};

}  // namespace strainwave::bench

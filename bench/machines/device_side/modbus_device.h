// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "bench/devices/wake.h"
#include "protocols/modbus/register_map.h"

namespace strainwave::bench {

/// What a device does wrong with its next answers.
struct ModbusDeviceFault {
  enum class Kind : std::uint8_t {
    kNone,
    kSilence,           // no answer
    kUnplugged,         // nothing is heard either
    kException,         // refuses, with `exception`; nothing is done
    kDelay,             // answers after `delay`
    kHalf,              // half an answer
    kOtherUnit,         // as if it were the next unit
    kOtherTransaction,  // TCP: with a number that is not the request's
  };
  Kind kind{Kind::kNone};
  int answers{-1};  // how many; −1: until the next fault is set
  std::uint8_t exception{4};
  std::chrono::milliseconds delay{};
};

/// A Modbus device made of a register map, over TCP or as RTU on a pseudo terminal, from a thread of its own.
/// Addresses without a register are refused; libmodbus makes the answers.
class ModbusDevice {
 public:
  /// All are called from the device's thread. `index` is the register's position in the map.
  struct Behaviour {
    std::function<double(std::size_t index)> read;
    std::function<bool(std::size_t index, double value)> write;  // false: refused, with exception 3
    std::function<void()> heard = [] {};                         // any request, before it is answered
  };
  struct Tcp {
    std::string address{"127.0.0.1"};
    int port{};  // 0: any free one
  };

  /// Modbus TCP. @throws std::system_error when it cannot listen there.
  ModbusDevice(protocols::modbus::RegisterMap map, int unit, Behaviour behaviour, const Tcp& tcp);
  /// RTU on a new pseudo terminal, whose name is `path()`. @throws std::system_error
  ModbusDevice(protocols::modbus::RegisterMap map, int unit, Behaviour behaviour);
  ModbusDevice(const ModbusDevice&) = delete;
  ModbusDevice& operator=(const ModbusDevice&) = delete;
  ~ModbusDevice();

  int port() const { return port_; }
  const std::string& path() const { return path_; }

  /// From any thread.
  void Set(const ModbusDeviceFault& fault);
  /// Over TCP; a line has none.
  void ResetConnections();
  /// What the register at `index` reads grows by this much a second from now on; 0 ends it.
  void Drift(std::size_t index, double per_s);

 private:
  struct Context;
  using Address = std::pair<protocols::modbus::Table, int>;
  using Bytes = std::vector<std::uint8_t>;
  struct Drifting {
    double per_s{};
    std::chrono::steady_clock::time_point since;
  };

  void Start();
  void ServeTcp();
  void ServeRtu();
  bool ServeOne(int descriptor);
  ModbusDeviceFault Fault();
  std::uint8_t Prepare(const std::uint8_t* pdu);
  std::uint8_t Fill(protocols::modbus::Table table, int first, int count);
  std::uint8_t Take(protocols::modbus::Table table, int first, const std::vector<std::uint16_t>& words);
  double Value(std::size_t index);
  Bytes AnswerTo(const std::uint8_t* request, int length);
  void Send(int descriptor, Bytes answer);

  const protocols::modbus::RegisterMap map_;
  const int unit_;
  Behaviour behaviour_;
  std::map<Address, std::size_t> owners_;  // of each mapped address
  std::unique_ptr<Context> context_;
  bool tcp_{};
  int port_{};
  std::string path_;
  Wake wake_;
  std::mutex mutex_;
  ModbusDeviceFault fault_;
  std::map<std::size_t, Drifting> drifting_;
  std::atomic<bool> stop_{false};
  std::atomic<bool> reset_{false};
  std::thread thread_;
};

}  // namespace strainwave::bench

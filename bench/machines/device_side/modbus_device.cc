// SPDX-License-Identifier: Apache-2.0
#include "bench/machines/device_side/modbus_device.h"

#include <fcntl.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "bench/devices/modbus/libmodbus.h"
#include "protocols/modbus/register_codec.h"

namespace strainwave::bench {
namespace {

namespace mb = protocols::modbus;
using Kind = ModbusDeviceFault::Kind;

constexpr std::size_t kMostClients = 8;
constexpr std::uint32_t kByteMicroseconds =
    100'000;  // a client that stops within a request does not keep the others
constexpr std::uint8_t kIllegalFunction = 1, kIllegalAddress = 2, kIllegalValue = 3, kDeviceFailure = 4,
                       kNoSuchUnit = 11;

int WordAt(const std::uint8_t* bytes) { return bytes[0] << 8 | bytes[1]; }

// Closed without a farewell.
void Reset(int connection) {
  constexpr linger kAtOnce{1, 0};
  ::setsockopt(connection, SOL_SOCKET, SO_LINGER, &kAtOnce, sizeof(kAtOnce));
  ::close(connection);
}

[[noreturn]] void Fail(const std::string& what) {
  throw std::system_error(errno, std::generic_category(), what);
}

}  // namespace

struct ModbusDevice::Context {
  ModbusContext modbus;
  modbus_mapping_t* mapping{};
  int listener{-1}, master{-1}, slave{-1};  // the slave is held, so that the master outlives its clients
  int pipe[2]{-1, -1};                      // libmodbus answers into it

  ~Context() {
    modbus_mapping_free(mapping);
    for (const int descriptor : {listener, master, slave, pipe[0], pipe[1]}) {
      if (descriptor >= 0) ::close(descriptor);
    }
    if (modbus != nullptr) modbus_set_socket(modbus.get(), -1);
  }
};

ModbusDevice::ModbusDevice(mb::RegisterMap map, int unit, Behaviour behaviour, const Tcp& tcp)
    : map_(std::move(map)),
      unit_(unit),
      behaviour_(std::move(behaviour)),
      context_(std::make_unique<Context>()),
      tcp_(true) {
  context_->modbus.reset(modbus_new_tcp(tcp.address.c_str(), tcp.port));
  if (context_->modbus != nullptr) {
    context_->listener = modbus_tcp_listen(context_->modbus.get(), static_cast<int>(kMostClients));
  }
  sockaddr_in address{};
  socklen_t size = sizeof(address);
  if (context_->listener < 0 ||
      ::getsockname(context_->listener, reinterpret_cast<sockaddr*>(&address), &size) != 0) {
    Fail(fmt::format("Modbus device cannot listen on {} port {}", tcp.address, tcp.port));
  }
  port_ = ntohs(address.sin_port);
  Start();
}

ModbusDevice::ModbusDevice(mb::RegisterMap map, int unit, Behaviour behaviour)
    : map_(std::move(map)),
      unit_(unit),
      behaviour_(std::move(behaviour)),
      context_(std::make_unique<Context>()) {
  context_->master = ::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
  char name[128];
  if (context_->master < 0 || ::grantpt(context_->master) != 0 || ::unlockpt(context_->master) != 0 ||
      ::ptsname_r(context_->master, name, sizeof(name)) != 0 ||
      (context_->slave = ::open(name, O_RDWR | O_NOCTTY | O_CLOEXEC)) < 0) {
    Fail("Modbus device has no pseudo terminal");
  }
  termios raw{};
  ::tcgetattr(context_->slave, &raw);
  ::cfmakeraw(&raw);
  ::tcsetattr(context_->slave, TCSANOW, &raw);
  path_ = name;
  context_->modbus.reset(modbus_new_rtu(name, 19'200, 'E', 8, 1));
  if (context_->modbus == nullptr || modbus_set_slave(context_->modbus.get(), unit) != 0) {
    Fail("Modbus device");
  }
  Start();
}

void ModbusDevice::Start() {
  int most = 0;
  for (std::size_t i = 0; i < map_.registers.size(); ++i) {
    const mb::Register& value = map_.registers[i];
    const int end = value.address + Length(value.type);
    for (int address = value.address; address < end; ++address) owners_[{value.table, address}] = i;
    most = std::max(most, end);
  }
  most = std::min(most + map_.read_gap, 65536);
  context_->mapping = modbus_mapping_new(most, most, most, most);
  if (context_->mapping == nullptr ||
      ::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, context_->pipe) != 0) {
    Fail("Modbus device");
  }
  modbus_set_byte_timeout(context_->modbus.get(), 0, kByteMicroseconds);
  modbus_set_indication_timeout(context_->modbus.get(), 0, kByteMicroseconds);
  thread_ = std::thread([this] { tcp_ ? ServeTcp() : ServeRtu(); });
}

ModbusDevice::~ModbusDevice() {
  stop_ = true;
  wake_.Call();
  thread_.join();
}

void ModbusDevice::Set(const ModbusDeviceFault& fault) {
  const std::lock_guard lock(mutex_);
  fault_ = fault;
}

void ModbusDevice::ResetConnections() {
  if (!tcp_) return;
  reset_ = true;
  wake_.Call();
}

// Of the next answer.
ModbusDeviceFault ModbusDevice::Fault() {
  const std::lock_guard lock(mutex_);
  return fault_.answers != 0 ? fault_ : ModbusDeviceFault{};
}

void ModbusDevice::Drift(std::size_t index, double per_s) {
  const std::lock_guard lock(mutex_);
  drifting_[index] = {per_s, std::chrono::steady_clock::now()};
}

double ModbusDevice::Value(std::size_t index) {
  const double value = behaviour_.read(index);
  const std::lock_guard lock(mutex_);
  const auto found = drifting_.find(index);
  if (found == drifting_.end()) return value;
  const std::chrono::duration<double> time = std::chrono::steady_clock::now() - found->second.since;
  return value + found->second.per_s * time.count();
}

// Puts what the registers read now where libmodbus answers from.
std::uint8_t ModbusDevice::Fill(mb::Table table, int first, int count) {
  int unknown = 0;
  for (int address = first; address < first + count; ++address) {
    const auto owner = owners_.find({table, address});
    if (owner == owners_.end()) {
      if (++unknown > map_.read_gap) return kIllegalAddress;
      continue;
    }
    unknown = 0;
    const mb::Register& value = map_.registers[owner->second];
    if (!CanRead(value)) return kIllegalAddress;
    const mb::Encoded encoded = Encode(value, Value(owner->second));
    if (encoded.problem != mb::CodecProblem::kNone) return kDeviceFailure;
    for (std::size_t i = 0; i < encoded.length; ++i) {
      const std::size_t at = value.address + i;
      modbus_mapping_t& to = *context_->mapping;
      if (table == mb::Table::kHolding) to.tab_registers[at] = encoded.words[i];
      if (table == mb::Table::kInput) to.tab_input_registers[at] = encoded.words[i];
      if (table == mb::Table::kCoil) to.tab_bits[at] = static_cast<std::uint8_t>(encoded.words[i]);
      if (table == mb::Table::kDiscrete) to.tab_input_bits[at] = static_cast<std::uint8_t>(encoded.words[i]);
    }
  }
  return 0;
}

std::uint8_t ModbusDevice::Take(mb::Table table, int first, const std::vector<std::uint16_t>& words) {
  const int end = first + static_cast<int>(words.size());
  std::vector<std::pair<std::size_t, double>> values;
  for (int address = first; address < end;) {
    const auto owner = owners_.find({table, address});
    if (owner == owners_.end()) return kIllegalAddress;
    const mb::Register& value = map_.registers[owner->second];
    const int length = Length(value.type);
    if (!CanWrite(value) || value.address != address || address + length > end) return kIllegalAddress;
    const mb::Decoded decoded =
        Decode(value, std::span(words).subspan(static_cast<std::size_t>(address - first),
                                               static_cast<std::size_t>(length)));
    if (decoded.problem != mb::CodecProblem::kNone) return kIllegalValue;
    values.emplace_back(owner->second, decoded.value);
    address += length;
  }
  for (const auto& [index, value] : values) {
    if (!behaviour_.write(index, value)) return kIllegalValue;
  }
  return 0;
}

// What must be done before libmodbus may answer; the exception that it is to answer with instead, or 0.
std::uint8_t ModbusDevice::Prepare(const std::uint8_t* pdu) {
  const int first = WordAt(pdu + 1);
  const int count = WordAt(pdu + 3);
  std::vector<std::uint16_t> words;
  switch (pdu[0]) {
    case 1:
      return Fill(mb::Table::kCoil, first, count);
    case 2:
      return Fill(mb::Table::kDiscrete, first, count);
    case 3:
      return Fill(mb::Table::kHolding, first, count);
    case 4:
      return Fill(mb::Table::kInput, first, count);
    case 5:
      return Take(mb::Table::kCoil, first, {static_cast<std::uint16_t>(count != 0 ? 1 : 0)});
    case 6:
      return Take(mb::Table::kHolding, first, {static_cast<std::uint16_t>(count)});
    case 15:
      if (pdu[5] != (count + 7) / 8) return kIllegalValue;
      for (int i = 0; i < count; ++i) words.push_back(pdu[6 + i / 8] >> (i % 8) & 1);
      return Take(mb::Table::kCoil, first, words);
    case 16:
      if (pdu[5] != 2 * count) return kIllegalValue;
      for (int i = 0; i < count; ++i) words.push_back(static_cast<std::uint16_t>(WordAt(pdu + 6 + 2 * i)));
      return Take(mb::Table::kHolding, first, words);
    default:
      return kIllegalFunction;
  }
}

ModbusDevice::Bytes ModbusDevice::AnswerTo(const std::uint8_t* request, int length) {
  modbus_t* const modbus = context_->modbus.get();
  const std::uint8_t* const pdu = request + modbus_get_header_length(modbus);
  const ModbusDeviceFault fault = Fault();
  const std::uint8_t exception = fault.kind == Kind::kException ? fault.exception
                                 : pdu[-1] == unit_             ? Prepare(pdu)
                                                                : kNoSuchUnit;
  modbus_set_socket(modbus, context_->pipe[1]);
  const int sent = exception != 0 ? modbus_reply_exception(modbus, request, exception)
                                  : modbus_reply(modbus, request, length, context_->mapping);
  Bytes answer(static_cast<std::size_t>(std::max(sent, 0)));
  if (!answer.empty())
    answer.resize(static_cast<std::size_t>(::read(context_->pipe[0], answer.data(), answer.size())));
  return answer;
}

void ModbusDevice::Send(int descriptor, Bytes answer) {
  const ModbusDeviceFault fault = Fault();
  {
    const std::lock_guard lock(mutex_);
    if (fault_.answers > 0) --fault_.answers;
  }
  const std::size_t unit_at = tcp_ ? 6 : 0;
  switch (fault.kind) {
    case Kind::kNone:
    case Kind::kException:
      break;
    case Kind::kSilence:
    case Kind::kUnplugged:
      return;
    case Kind::kDelay:
      wake_.Wait(fault.delay);
      break;
    case Kind::kHalf:
      answer.resize(answer.size() / 2);
      break;
    case Kind::kOtherUnit:
      ++answer[unit_at];
      break;
    case Kind::kOtherTransaction:
      if (tcp_) answer[0] ^= 0x55;
      break;
  }
  // A client that reads nothing loses its answer.
  [[maybe_unused]] const auto written = tcp_ ? ::send(descriptor, answer.data(), answer.size(), MSG_NOSIGNAL)
                                             : ::write(descriptor, answer.data(), answer.size());
}

bool ModbusDevice::ServeOne(int descriptor) {
  std::uint8_t request[MODBUS_MAX_ADU_LENGTH] = {};
  modbus_set_socket(context_->modbus.get(), descriptor);
  const int length = modbus_receive(context_->modbus.get(), request);
  if (length < 0) return false;
  if (length == 0) return true;  // to another unit of the line
  if (Fault().kind == Kind::kUnplugged) return true;
  behaviour_.heard();
  Send(descriptor, AnswerTo(request, length));
  return true;
}

void ModbusDevice::ServeRtu() {
  while (!stop_) {
    if (WaitReadable(context_->master, &wake_, std::chrono::hours(1)) != Waited::kReadable) continue;
    if (!ServeOne(context_->master)) ::tcflush(context_->slave, TCIOFLUSH);
  }
}

void ModbusDevice::ServeTcp() {
  std::vector<pollfd> sockets{{wake_.descriptor(), POLLIN, 0}, {context_->listener, POLLIN, 0}};
  while (!stop_) {
    if (::poll(sockets.data(), sockets.size(), -1) <= 0) continue;
    if (reset_.exchange(false)) {
      wake_.Take();
      for (std::size_t i = 2; i < sockets.size(); ++i) Reset(sockets[i].fd);
      sockets.resize(2);
      continue;
    }
    for (std::size_t i = sockets.size(); i-- > 2;) {
      if (sockets[i].revents == 0 || ServeOne(sockets[i].fd)) continue;
      ::close(sockets[i].fd);
      sockets.erase(sockets.begin() + static_cast<std::ptrdiff_t>(i));
    }
    if ((sockets[1].revents & POLLIN) == 0) continue;
    const int client = ::accept4(context_->listener, nullptr, nullptr, SOCK_CLOEXEC);
    if (client >= 0 && sockets.size() >= kMostClients + 2) {
      ::close(client);
    } else if (client >= 0) {
      sockets.push_back({client, POLLIN, 0});
    }
  }
  for (std::size_t i = 2; i < sockets.size(); ++i) ::close(sockets[i].fd);
}

}  // namespace strainwave::bench

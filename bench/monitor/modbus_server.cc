// SPDX-License-Identifier: Apache-2.0
#include "bench/monitor/modbus_server.h"

#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <vector>

#include <fmt/format.h>
#include <modbus.h>

#include "bench/monitor/modbus_registers.h"

namespace strainwave::bench {
namespace {

constexpr std::size_t kMostClients = 8;
constexpr int kPatience_ms = 100;            // in which a stop is seen
constexpr std::uint32_t kByte_us = 100'000;  // a client that stops within a request does not keep the others

}  // namespace

struct ModbusServer::Context {
  modbus_t* modbus{};
  modbus_mapping_t* mapping{};

  ~Context() {
    modbus_mapping_free(mapping);
    modbus_free(modbus);
  }
};

ModbusServer::ModbusServer(const ListenSettings& settings, const Board& board)
    : board_(board), context_(std::make_unique<Context>()) {
  context_->modbus = modbus_new_tcp(settings.address.c_str(), settings.port);
  const auto registers = ModbusRegisters({}, board.frame(), 0).size();
  context_->mapping = modbus_mapping_new(0, 0, 0, static_cast<int>(registers));
  if (context_->modbus != nullptr) {
    modbus_set_byte_timeout(context_->modbus, 0, kByte_us);
    modbus_set_indication_timeout(context_->modbus, 0, kByte_us);
    listener_ = modbus_tcp_listen(context_->modbus, static_cast<int>(kMostClients));
  }
  sockaddr_in address{};
  socklen_t size = sizeof(address);
  if (listener_ < 0 || context_->mapping == nullptr ||
      ::getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size) != 0) {
    throw std::system_error(
        errno, std::generic_category(),
        fmt::format("modbus cannot listen on {} port {}", settings.address, settings.port));
  }
  port_ = ntohs(address.sin_port);
  thread_ = std::thread([this] { Serve(); });
}

ModbusServer::~ModbusServer() {
  stop_ = true;
  thread_.join();
  ::close(listener_);
}

void ModbusServer::Serve() {
  std::vector<pollfd> sockets{{listener_, POLLIN, 0}};
  while (!stop_) {
    if (::poll(sockets.data(), sockets.size(), kPatience_ms) <= 0) continue;
    for (std::size_t i = sockets.size(); i-- > 1;) {
      if (sockets[i].revents == 0) continue;
      modbus_set_socket(context_->modbus, sockets[i].fd);
      std::uint8_t request[MODBUS_TCP_MAX_ADU_LENGTH];
      const int length = modbus_receive(context_->modbus, request);
      if (length < 0) {
        ::close(sockets[i].fd);
        sockets.erase(sockets.begin() + static_cast<std::ptrdiff_t>(i));
        continue;
      }
      const auto registers = ModbusRegisters(board_.State(), board_.frame(), board_.NowMilliseconds());
      std::ranges::copy(registers, context_->mapping->tab_input_registers);
      if (length > 0) modbus_reply(context_->modbus, request, length, context_->mapping);
    }
    if ((sockets[0].revents & POLLIN) != 0) {
      const int client = ::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
      if (client >= 0 && sockets.size() > kMostClients) {
        ::close(client);
      } else if (client >= 0) {
        sockets.push_back({client, POLLIN, 0});
      }
    }
  }
  for (std::size_t i = 1; i < sockets.size(); ++i) ::close(sockets[i].fd);
}

}  // namespace strainwave::bench

// SPDX-License-Identifier: Apache-2.0
#include "bench/devices/modbus/modbus_client.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <system_error>
#include <utility>

namespace strainwave::bench {
namespace {

using std::chrono::nanoseconds;

constexpr const char* kConnection = "connection";

protocols::modbus::RegisterMap Sound(protocols::modbus::RegisterMap map) {
  std::string problems;
  for (const auto& problem : CheckMap(map)) problems += (problems.empty() ? "" : "; ") + problem.what;
  if (!problems.empty()) throw std::invalid_argument(fmt::format("map of {}: {}", map.device, problems));
  return map;
}

}  // namespace

ModbusClient::ModbusClient(ModbusSettings settings, protocols::modbus::RegisterMap map,
                           const BenchClock& clock, ModbusDuties* duties)
    : map_(Sound(std::move(map))),
      clock_(clock),
      duties_(duties),
      link_(std::move(settings), &wake_),
      poller_(map_, clock),
      trouble_{{kConnection, "not made yet"}},
      thread_([this] { Run(); }) {}

ModbusClient::~ModbusClient() {
  stop_ = true;
  wake_.Call();
  thread_.join();
}

std::string ModbusClient::trouble() const {
  const std::lock_guard lock(trouble_mutex_);
  std::string lines;
  for (const auto& [asked, text] : trouble_) {
    lines += fmt::format("{}{}: {}", lines.empty() ? "" : "\n", asked, text);
  }
  return lines;
}

void ModbusClient::NoteText(const std::string& asked, const std::string& text) {
  const std::lock_guard lock(trouble_mutex_);
  if (text.empty()) {
    trouble_.erase(asked);
  } else {
    trouble_[asked] = text;
  }
}

void ModbusClient::Note(const std::string& asked, const ModbusReply& reply) {
  if (reply.outcome == ModbusReply::Outcome::kInterrupted) return;
  NoteText(asked, reply.good() ? "" : Words(reply, link_.settings()));
}

bool ModbusClient::Connect() {
  try {
    link_.Open();
    NoteText(kConnection, "");
  } catch (const std::system_error& error) {
    NoteText(kConnection, error.what());
    return false;
  }
  if (duties_ == nullptr) return true;
  const ModbusReply reply = duties_->Connected(link_, poller_);
  Note("setting up", reply);
  if (!reply.good()) {
    link_.Close();
    duties_->Lost();
  }
  return reply.good();
}

// Calls do not shorten it: whoever calls a device that is not there must not have it tried all the time.
void ModbusClient::Pause(nanoseconds time) {
  const nanoseconds end = clock_.Now() + time;
  while (!stop_ && clock_.Now() < end) {
    wake_.Wait(end - clock_.Now());
    wake_.Take();
  }
}

ModbusReply ModbusClient::OneRound(nanoseconds& next_write) {
  const bool called = wake_.Take();
  if (duties_ != nullptr && (called || clock_.Now() >= next_write)) {
    next_write = clock_.Now() + duties_->WritePeriod();
    const ModbusReply reply = duties_->Write(link_);
    Note("writing", reply);
    if (!reply.good()) return reply;
  }
  if (poller_.NextDue() > clock_.Now()) return {};
  const ModbusReply reply = poller_.PollOne(link_);
  Note("reading " + poller_.last_asked(), reply);
  return reply;
}

void ModbusClient::Run() {
  const ModbusSettings& settings = link_.settings();
  nanoseconds pause = settings.first_pause;
  nanoseconds next_write{};
  while (!stop_) {
    if (!link_.is_open()) {
      connected_ = false;
      if (!Connect()) {
        Pause(pause);
        pause = std::min<nanoseconds>(2 * pause, settings.longest_pause);
        continue;
      }
      next_write = clock_.Now();
    }
    const ModbusReply reply = OneRound(next_write);
    if (!link_.is_open()) {
      connected_ = false;
      if (duties_ != nullptr) duties_->Lost();
      Pause(pause);
      pause = std::min<nanoseconds>(2 * pause, settings.longest_pause);
      continue;
    }
    if (reply.good()) {
      connected_ = true;
      pause = settings.first_pause;
    }
    const nanoseconds next =
        std::min(poller_.NextDue(), duties_ != nullptr ? next_write : nanoseconds::max());
    const nanoseconds now = clock_.Now();
    if (next > now && !stop_) wake_.Wait(std::min<nanoseconds>(next - now, std::chrono::seconds(1)));
  }
  if (link_.is_open() && duties_ != nullptr) duties_->Leave(link_);
  link_.Close();
}

}  // namespace strainwave::bench

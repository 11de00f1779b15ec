// SPDX-License-Identifier: Apache-2.0
#include "bench/devices/modbus/modbus_poller.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "protocols/modbus/register_codec.h"

namespace strainwave::bench {
namespace {

namespace mb = protocols::modbus;
using std::chrono::nanoseconds;

std::string Described(const mb::RegisterMap& map, const mb::ReadRequest& request) {
  constexpr std::string_view kTables[] = {"holding", "input", "coil", "discrete"};
  std::vector<std::string_view> names;
  for (const std::size_t index : request.registers) names.push_back(map.registers[index].name);
  return fmt::format("{} {} to {} ({})", kTables[static_cast<std::size_t>(request.table)], request.first,
                     request.first + request.count - 1, fmt::join(names, ", "));
}

}  // namespace

ModbusPoller::ModbusPoller(const mb::RegisterMap& map, const BenchClock& clock)
    : map_(map), clock_(clock), values_(map.registers.size()) {
  const nanoseconds now = clock.Now();
  for (const mb::Register& value : map.registers) {
    due_.push_back(value.poll_period.count() > 0 ? now : nanoseconds::max());
  }
}

nanoseconds ModbusPoller::NextDue() const {
  if (!pending_.empty()) return nanoseconds::min();
  return due_.empty() ? nanoseconds::max() : *std::ranges::min_element(due_);
}

void ModbusPoller::PlanWhatIsDue(nanoseconds now) {
  std::vector<std::size_t> wanted;
  for (std::size_t i = 0; i < due_.size(); ++i) {
    if (due_[i] > now) continue;
    wanted.push_back(i);
    due_[i] = std::max(due_[i] + map_.registers[i].poll_period, now);
  }
  for (auto& request : PlanReads(map_, wanted)) pending_.push_back(std::move(request));
}

ModbusReply ModbusPoller::PollOne(ModbusLink& link) {
  if (pending_.empty()) PlanWhatIsDue(clock_.Now());
  if (pending_.empty()) return {};
  const mb::ReadRequest request = std::move(pending_.front());
  pending_.pop_front();
  return Read(link, request);
}

ModbusReply ModbusPoller::ReadNow(ModbusLink& link, std::span<const std::size_t> registers) {
  for (const auto& request : PlanReads(map_, registers)) {
    if (const ModbusReply reply = Read(link, request); !reply.good()) return reply;
  }
  return {};
}

ModbusReply ModbusPoller::Read(ModbusLink& link, const mb::ReadRequest& request) {
  std::vector<std::uint16_t> words(request.count);
  const nanoseconds asked = clock_.Now();  // the values are no older than this
  const ModbusReply reply = link.Read(request, words);
  last_asked_ = Described(map_, request);
  const bool refused = reply.outcome == ModbusReply::Outcome::kException;
  if (!reply.good() && !refused) return reply;  // what was read before grows stale by itself
  for (const std::size_t index : request.registers) {
    const mb::Register& value = map_.registers[index];
    if (refused) {
      values_[index].Set({});
      continue;
    }
    const auto at = static_cast<std::size_t>(value.address - request.first);
    const mb::Decoded decoded =
        Decode(value, std::span(words).subspan(at, static_cast<std::size_t>(Length(value.type))));
    values_[index].Set({decoded.value, asked, decoded.problem == mb::CodecProblem::kNone});
  }
  return reply;
}

ChannelValue ModbusPoller::Value(std::size_t index) const noexcept {
  ChannelValue value = values_[index].Get();
  const nanoseconds good_for = GoodFor(map_.registers[index]);
  if (good_for.count() != 0 && clock_.Now() - value.time > good_for) value.good = false;
  return value;
}

}  // namespace strainwave::bench

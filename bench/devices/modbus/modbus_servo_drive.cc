// SPDX-License-Identifier: Apache-2.0
#include "bench/devices/modbus/modbus_servo_drive.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "protocols/modbus/register_codec.h"

namespace strainwave::bench {
namespace {

namespace mb = protocols::modbus;
using protocols::PowerState;
using std::chrono::nanoseconds;

constexpr std::uint16_t kMostCount = 0x7FFF;  // fits a signed register, too

// As near to what is wanted as the register holds; a set point is never a reason not to be able to stop.
double Held(const mb::Register& value, double wanted) {
  const double least = value.least.value_or(-std::numeric_limits<double>::infinity());
  const double most = value.most.value_or(std::numeric_limits<double>::infinity());
  const double held = std::clamp(wanted, least, most);
  return Encode(value, held).problem == mb::CodecProblem::kNone ? held : 0.0;
}

// After how much a value goes over to where it was; 0: one without ends.
double Whole(const mb::Register& value) {
  switch (value.type) {
    case mb::ValueType::kInt16:
    case mb::ValueType::kUint16:
      return std::abs(value.scale) * 65536.0;
    case mb::ValueType::kInt32:
    case mb::ValueType::kUint32:
      return std::abs(value.scale) * 4294967296.0;
    case mb::ValueType::kFloat32:
    case mb::ValueType::kBit:
      break;
  }
  return 0.0;
}

}  // namespace

ModbusServoDrive::ModbusServoDrive(ModbusSettings settings, const mb::RegisterMap& map,
                                   const ModbusServoProfile& profile, const BenchClock& clock,
                                   std::function<bool()> others_supervised, nanoseconds patience)
    : map_(map),
      profile_(profile),
      at_(FindServoRegisters(map_, profile_)),
      clock_(clock),
      others_supervised_(std::move(others_supervised)),
      patience_(patience),
      heard_ns_(clock.Now().count()),
      client_(std::move(settings), map, clock, this) {}

void ModbusServoDrive::Order(bool at_once) noexcept {
  heard_ns_ = clock_.Now().count();
  command_.Set(mine_);
  if (at_once) client_.Call();
}

void ModbusServoDrive::Enable(DriveMode mode) noexcept {
  if (mode == DriveMode::kPosition) return;
  mine_.enable = true;
  mine_.quick = false;
  mine_.mode = mode;
  mine_.set_point = 0.0;
  ++mine_.enables;
  Order(true);
}

void ModbusServoDrive::Disable() noexcept {
  const bool news = mine_.enable;
  mine_.enable = false;
  mine_.set_point = 0.0;
  Order(news);
}

void ModbusServoDrive::QuickStop() noexcept {
  const bool news = mine_.enable || !mine_.quick || !mine_.brake_engaged;
  mine_.enable = false;
  mine_.quick = true;
  mine_.set_point = 0.0;
  mine_.brake_engaged = true;
  Order(news);
}

void ModbusServoDrive::ResetFault() noexcept {
  mine_.enable = false;
  mine_.set_point = 0.0;
  mine_.brake_engaged = true;
  ++mine_.resets;
  Order(true);
}

void ModbusServoDrive::SetBrake(bool engaged) noexcept {
  const bool news = mine_.brake_engaged != engaged;
  mine_.brake_engaged = engaged;
  Order(news);
}

void ModbusServoDrive::Take(DriveMode mode, double value) noexcept {
  const bool in_force = mine_.enable && mine_.mode == mode && IsEnabledAsAsked(Power());
  if (in_force && std::isfinite(value)) mine_.set_point = value;
  Order(false);
}

void ModbusServoDrive::CommandSpeed(double speed_rad_per_s) noexcept {
  Take(DriveMode::kSpeed, speed_rad_per_s);
}

void ModbusServoDrive::CommandPosition(double) noexcept { heard_ns_ = clock_.Now().count(); }

void ModbusServoDrive::CommandTorque(double torque_Nm) noexcept { Take(DriveMode::kTorque, torque_Nm); }

std::optional<PowerState> ModbusServoDrive::PowerOf(double status) const noexcept {
  if (!(status >= 0.0)) return std::nullopt;
  const auto bits = static_cast<std::uint32_t>(status);
  for (const ModbusServoProfile::Status& row : profile_.status) {
    if ((bits & row.mask) == row.value) return row.state;
  }
  return std::nullopt;
}

std::optional<PowerState> ModbusServoDrive::Power() const noexcept {
  const ChannelValue status = client_.Value(at_.status);
  return status.good ? PowerOf(status.value) : std::nullopt;
}

// What was read before the drive was last enabled says nothing of what became of that.
bool ModbusServoDrive::IsEnabledAsAsked(std::optional<PowerState> power) const noexcept {
  return power == PowerState::kOperationEnabled && enables_begun_ == command_.Get().enables &&
         client_.Value(at_.status).time.count() > begun_ns_;
}

double ModbusServoDrive::Position_rad() const noexcept {
  if (!at_.actual_position) return 0.0;
  const double told_rad = client_.Value(*at_.actual_position).value;
  const double whole_rad = Whole(map_.registers[*at_.actual_position]);
  const double counted_rad = counted_rad_;
  if (whole_rad == 0.0 || !std::isfinite(told_rad)) return told_rad;
  return counted_rad + std::remainder(told_rad - counted_rad, whole_rad);
}

DriveActual ModbusServoDrive::Actual() const noexcept {
  heard_ns_ = clock_.Now().count();
  const ChannelValue status = client_.Value(at_.status);
  const ChannelValue speed = client_.Value(at_.actual_speed);
  const ChannelValue torque = client_.Value(at_.actual_torque);
  const ChannelValue brake = client_.Value(at_.brake);
  // An answer that grows old stays the last one; its time tells.
  const bool has_status = status.time.count() != 0;
  const std::optional<PowerState> power = has_status ? PowerOf(status.value) : std::nullopt;
  if (power && status.good && speed.good && torque.good && brake.good) {
    told_ns_ = std::min({status.time, speed.time, torque.time}).count();
  }
  DriveActual actual;
  actual.time = nanoseconds(told_ns_);
  actual.speed_rad_per_s = speed.value;
  actual.torque_Nm = torque.value;
  actual.tells_position = at_.actual_position && client_.Value(*at_.actual_position).good;
  actual.position_rad = Position_rad();
  actual.power = power.value_or(PowerState::kNotReadyToSwitchOn);
  if (mine_.enable && power == PowerState::kOperationEnabled && !IsEnabledAsAsked(power)) {
    actual.power = PowerState::kSwitchedOn;
  }
  actual.brake_engaged = brake.good && brake.value == profile_.brake_engaged;
  return actual;
}

std::optional<bool> ModbusServoDrive::tells_brake_engaged() const noexcept {
  const ChannelValue brake = client_.Value(at_.brake);
  if (!client_.connected() || !brake.good) return std::nullopt;
  return brake.value == profile_.brake_engaged;
}

nanoseconds ModbusServoDrive::poll_period() const {
  const auto period = [this](std::size_t index) { return map_.registers[index].poll_period; };
  return std::max({period(at_.status), period(at_.actual_speed), period(at_.actual_torque)});
}

std::string ModbusServoDrive::fault() const {
  if (Power() != PowerState::kFault) return {};
  return FaultWords(at_.fault_code ? client_.Value(*at_.fault_code).value : ChannelValue{}.value);
}

std::string ModbusServoDrive::identity() const {
  std::string words;
  for (const auto& [name, at] : {std::pair{"product", at_.product_code}, {"serial", at_.serial_number}}) {
    if (!at) continue;
    const ChannelValue value = client_.Value(*at);
    words += fmt::format("{}{} ", words.empty() ? "" : ", ", name);
    words += value.good ? fmt::format("{:.0f}", value.value) : "not known";
  }
  return words;
}

// Torque off comes first, by itself; the brake follows whether that was answered or not.
ModbusReply ModbusServoDrive::WriteStopped(ModbusLink& link, bool quick, const Values& rest) {
  const Values stop{{at_.control, quick ? profile_.control.quick_stop : profile_.control.off}};
  auto requests = PlanWrites(map_, stop);
  for (auto& request : PlanWrites(map_, rest)) requests.push_back(std::move(request));
  return link.WriteEach(requests);
}

ModbusReply ModbusServoDrive::WriteStop(ModbusLink& link, bool quick, bool brake_engaged) {
  return WriteStopped(link, quick,
                      {{at_.speed_set_point, 0.0},
                       {at_.torque_set_point, 0.0},
                       {at_.brake, brake_engaged ? profile_.brake_engaged : profile_.brake_released}});
}

ModbusReply ModbusServoDrive::WriteCommand(ModbusLink& link, const Command& command, bool enable) {
  const bool speed_mode = command.mode == DriveMode::kSpeed;
  const auto set_point = [&](std::size_t index, bool in_force) {
    return std::pair(index, enable && in_force ? Held(map_.registers[index], command.set_point) : 0.0);
  };
  Values values{set_point(at_.speed_set_point, speed_mode),
                set_point(at_.torque_set_point, !speed_mode),
                {at_.mode, speed_mode ? profile_.speed_mode : profile_.torque_mode},
                {at_.brake, command.brake_engaged ? profile_.brake_engaged : profile_.brake_released}};
  if (at_.watchdog) {
    count_ = count_ == kMostCount ? 0 : static_cast<std::uint16_t>(count_ + 1);
    values.emplace_back(*at_.watchdog, count_);
  }
  // Enabled with the set points already there, stopped before them.
  if (!enable) return WriteStopped(link, command.quick, values);
  if (const ModbusReply reply = link.WriteUnlessCalled(PlanWrites(map_, values)); !reply.good()) return reply;
  // Said until the drive is enabled, and not again: one that has restarted in between must not come up by it.
  if (was_enabled_) return {};
  const Values control{{at_.control, profile_.control.enable}};
  return link.WriteUnlessCalled(PlanWrites(map_, control));
}

ModbusReply ModbusServoDrive::Connected(ModbusLink& link, ModbusPoller& poller) {
  Lost();
  if (const ModbusReply reply = WriteStop(link, true, true); !reply.good()) return reply;
  poller_ = &poller;
  if (const ModbusReply reply = SetWatchdogTime(link); !reply.good()) return reply;
  for (const auto& at : {at_.product_code, at_.serial_number}) {
    if (!at) continue;
    if (const ModbusReply reply = poller.ReadNow(link, std::span(&*at, 1)); !reply.good()) return reply;
  }
  is_supervised_ = true;
  return {};
}

ModbusReply ModbusServoDrive::SetWatchdogTime(ModbusLink& link) {
  const double wanted_s = std::chrono::duration<double>(profile_.watchdog_time).count();
  const Values time{{at_.watchdog_time, wanted_s}};
  if (const ModbusReply reply = link.Write(PlanWrites(map_, time)); !reply.good()) return reply;
  if (const ModbusReply reply = poller_->ReadNow(link, std::span(&at_.watchdog_time, 1)); !reply.good()) {
    return reply;
  }
  const ChannelValue read = poller_->Value(at_.watchdog_time);
  const mb::Register& value = map_.registers[at_.watchdog_time];
  if (std::isnan(read.value) || Encode(value, read.value).words != Encode(value, wanted_s).words) {
    return {ModbusReply::Outcome::kWrongAnswer, 0,
            "the watchdog time reads back as another than was written; the drive would not stop by itself"};
  }
  return {};
}

bool ModbusServoDrive::WatchdogFollows() const noexcept {
  if (!at_.watchdog || map_.registers[*at_.watchdog].poll_period.count() == 0) return true;
  const ChannelValue read = client_.Value(*at_.watchdog);
  if (!std::isfinite(read.value)) return false;
  const auto behind =
      static_cast<std::uint16_t>(count_ - static_cast<std::uint16_t>(read.value)) & kMostCount;
  const auto periods = (clock_.Now() - read.time) / profile_.period;
  constexpr int kOnTheWay = 3;
  return behind <= periods + kOnTheWay;
}

ModbusReply ModbusServoDrive::Write(ModbusLink& link) {
  if (const double position_rad = Position_rad(); std::isfinite(position_rad)) counted_rad_ = position_rad;
  Command command = command_.Get();
  const bool enable = command.enable && command.enables > void_enables_;
  // Once something went wrong, the brake stays on until somebody enables the drive anew.
  if (command.enables <= void_enables_) command.brake_engaged = true;
  if (command.enable && !enable) command.quick = true;
  if (command.resets != resets_done_) {
    const Values off{{at_.control, profile_.control.off}};
    const Values reset{{at_.control, profile_.control.reset_fault}};
    if (const ModbusReply reply = link.Write(PlanWrites(map_, off)); !reply.good()) return reply;
    const ModbusReply reply = link.Write(PlanWrites(map_, reset));
    if (reply.good()) resets_done_ = command.resets;
    return reply;
  }
  const std::optional<PowerState> power = Power();
  const bool begun = enable && command.enables == enables_begun_;
  was_enabled_ = was_enabled_ && begun;  // else it is of an enabling that is over
  const bool hangs = clock_.Now().count() - heard_ns_ > patience_.count();
  const bool left = was_enabled_ && power && power != PowerState::kOperationEnabled;  // by itself
  if (enable && (hangs || left || power == PowerState::kFault || (was_enabled_ && !WatchdogFollows()))) {
    void_enables_ = command.enables;
    was_enabled_ = false;
    return WriteStop(link, true, true);
  }
  was_enabled_ = begun && (was_enabled_ || IsEnabledAsAsked(power));
  if (enable && command.enables != enables_begun_ && others_supervised_ && !others_supervised_()) {
    void_enables_ = command.enables;
    return WriteStop(link, true, true);
  }
  if (enable && command.enables != enables_begun_) {
    // One that has restarted in between has lost it, and on a line nobody has noticed.
    if (const ModbusReply reply = SetWatchdogTime(link); !reply.good()) return reply;
    // From a quick stop the way leads through off, so that a stop never turns into motion by one word.
    const ModbusReply reply = WriteStop(link, false, true);
    // Before it counts as begun: `IsEnabledAsAsked` looks from other threads.
    begun_ns_ = clock_.Now().count();
    if (reply.good()) enables_begun_ = command.enables;
    return reply;
  }
  return WriteCommand(link, command, enable);
}

void ModbusServoDrive::Lost() noexcept {
  is_supervised_ = false;
  void_enables_ = command_.Get().enables;
  was_enabled_ = false;
}

void ModbusServoDrive::Leave(ModbusLink& link) {
  if (WriteStop(link, true, true).good()) return;
  WriteStop(link, true, true);
}

}  // namespace strainwave::bench

// SPDX-License-Identifier: Apache-2.0
// Where each channel of a bench of metal comes from.
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "bench/machines/field/field_machine.h"

namespace strainwave::bench {

namespace {

// Without the unit that it ends in.
std::string BareName(const std::string& channel) {
  for (const std::string_view unit : {"_m_per_s2", "_rad_per_s"}) {
    if (channel.ends_with(unit)) return channel.substr(0, channel.size() - unit.size());
  }
  return channel.substr(0, channel.rfind('_'));
}

}  // namespace

// A device that plays one role has one channel, whose unit its map must have in SI; nothing for another
// device.
std::function<ChannelValue()> FieldMachine::ChannelOfRole(const ChannelLink& link) {
  const auto demand = [&link](std::string_view only) {
    if (link.source == only) return;
    throw std::invalid_argument(fmt::format("line {}: device {} has no channel {} (must be {})", link.line,
                                            link.device, link.source, only));
  };
  if (const auto found = amplifiers_.find(link.device); found != amplifiers_.end()) {
    demand("torque_Nm");
    return [amplifier = found->second.get()] { return amplifier->Torque(); };
  }
  if (const auto found = chambers_.find(link.device); found != chambers_.end()) {
    demand("temperature_degC");
    return [chamber = found->second.get()] { return chamber->Temperature(); };
  }
  return {};
}

std::function<ChannelValue()> FieldMachine::ChannelFrom(const ChannelLink& link) {
  if (auto of_role = ChannelOfRole(link)) return of_role;
  const double to_si = SiFactor(link.source);
  if (const auto found = sources_.find(link.device); found != sources_.end()) {
    const SourceReader* const reader = found->second.get();
    const auto channel = reader->Find(link.source);
    if (!channel) {
      throw std::invalid_argument(
          fmt::format("line {}: device {} has no channel {} (must be one that it sends)", link.line,
                      link.device, link.source));
    }
    return FromSource(*reader, *channel, to_si);
  }
  if (const auto hid = hid_.find(link.device); hid != hid_.end()) {
    const auto& fields = hid->second.profile.channels;
    const auto field = std::ranges::find(fields, BareName(link.source), &protocols::HidField::name);
    if (field == fields.end()) {
      throw std::invalid_argument(
          fmt::format("line {}: device {} has no channel {} (must be one of its profile)", link.line,
                      link.device, BareName(link.source)));
    }
    const HidChannels* const channels = hid->second.channels.get();
    return [channels, at = static_cast<std::size_t>(field - fields.begin()), to_si] {
      ChannelValue value = channels->Value(at);
      value.value *= to_si;
      return value;
    };
  }
  const auto found = modbus_.find(link.device);
  if (found == modbus_.end()) {
    throw std::invalid_argument(fmt::format(
        "line {}: device {} has no channels here (must be a stream or on Modbus)", link.line, link.device));
  }
  const ModbusClient* const client = found->second.get();
  const auto at = RegisterOf(*client, link.source);
  if (!at) {
    throw std::invalid_argument(fmt::format("line {}: device {} has no register {} (must be one of its map)",
                                            link.line, link.device, link.source));
  }
  // The map has made SI of it already.
  return [client, at = *at] { return client->Value(at); };
}

// Under the channel's name, or under that without its unit.
std::optional<std::size_t> FieldMachine::RegisterOf(const ModbusClient& client, const std::string& source) {
  const auto index = protocols::modbus::Find(client.map(), source);
  return index ? index : protocols::modbus::Find(client.map(), BareName(source));
}

std::function<ChannelValue()> FieldMachine::FromSource(const SourceReader& reader, std::size_t channel,
                                                       double to_si) {
  return [this, &reader, channel, to_si] {
    const SourceSnapshot snapshot = reader.Newest();
    const bool fresh = snapshot.time.count() != 0 && clock_.Now() - snapshot.time < stale_after_;
    return ChannelValue{snapshot.values[channel] * to_si, snapshot.time,
                        fresh && (snapshot.bad_channels >> channel & 1U) == 0, snapshot.sampled};
  };
}

FieldChannels FieldMachine::Channels() {
  FieldChannels channels;
  constexpr std::pair<std::string_view, Channel> kSlow[] = {
      {"input_angle", Channel::kInputAngle},
      {"output_angle", Channel::kOutputAngle},
      {"input_speed", Channel::kInputSpeed},
      {"output_torque", Channel::kOutputTorque},
      {"motor_torque", Channel::kMotorTorque},
      {"gear_temperature", Channel::kGearTemperature},
      {"ambient_temperature", Channel::kAmbientTemperature}};
  links_.clear();
  for (const ChannelLink& link : bench_.channels) {
    const auto* const slow =
        std::ranges::find_if(kSlow, [&](const auto& known) { return known.first == link.channel; });
    if (slow != std::end(kSlow)) {
      channels.channels[static_cast<std::size_t>(slow->second)] = ChannelFrom(link);
      links_.emplace_back(&link, channels.channels[static_cast<std::size_t>(slow->second)]);
      continue;
    }
    const auto* const axis = std::ranges::find(kAccelerometers, link.channel);
    const auto source = sources_.find(link.device);
    if (axis == kAccelerometers.end() || source == sources_.end()) continue;
    const auto channel = source->second->Find(link.source);
    if (!channel || (channels.vibration != nullptr && channels.vibration != source->second.get())) {
      throw std::invalid_argument(
          fmt::format("line {}: {} is not a channel of {} (must be, and all accelerometers of one device)",
                      link.line, link.source, link.device));
    }
    channels.vibration = source->second.get();
    links_.emplace_back(&link, FromSource(*source->second, *channel, 1.0));
    channels.accelerometers[static_cast<std::size_t>(axis - kAccelerometers.begin())] = *channel;
  }
  const auto turn = [&channels](Channel channel, int sign) {
    auto& read = channels.channels[static_cast<std::size_t>(channel)];
    if (sign > 0 || !read) return;
    read = [as_counted = std::move(read)] {
      ChannelValue value = as_counted();
      value.value = -value.value;
      return value;
    };
  };
  turn(Channel::kInputAngle, bench_.input_encoder.sign);
  turn(Channel::kOutputAngle, bench_.output_encoder.sign);
  const auto from_drive = [this](double DriveActual::*value) {
    return [this, value] {
      const DriveActual actual = driving_->Actual();
      const bool good = std::isfinite(actual.*value) && clock_.Now() - actual.time < stale_after_;
      return ChannelValue{actual.*value, actual.time, good};
    };
  };
  auto& speed = channels.channels[static_cast<std::size_t>(Channel::kInputSpeed)];
  if (!speed) speed = from_drive(&DriveActual::speed_rad_per_s);
  auto& torque = channels.channels[static_cast<std::size_t>(Channel::kMotorTorque)];
  if (!torque) torque = from_drive(&DriveActual::torque_Nm);
  if (shunt_) {
    channels.connect_shunt = [this, client = modbus_.at(bench_.transducer.shunt.device).get()](bool on) {
      if (shunt_->Set(on)) client->Call();
    };
  }
  channels.mark_trip = [this] {
    for (const auto& [name, reader] : sources_) reader->MarkTrip();
  };
  if (pendant_) channels.quick_stop_pressed = [this] { return QuickStopPressed(); };
  if (channels.vibration != nullptr) {
    channels.channels[static_cast<std::size_t>(Channel::kVibrationRms)] = [this,
                                                                           reader = channels.vibration] {
      const SourceSnapshot snapshot = reader->Newest();
      const bool fresh = snapshot.time.count() != 0 && clock_.Now() - snapshot.time < stale_after_;
      return ChannelValue{
          snapshot.vibration_rms_m_per_s2, snapshot.time,
          fresh && snapshot.bad_channels == 0 && std::isfinite(snapshot.vibration_rms_m_per_s2)};
    };
  }
  return channels;
}

}  // namespace strainwave::bench

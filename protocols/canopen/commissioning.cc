// SPDX-License-Identifier: Apache-2.0
#include "protocols/canopen/commissioning.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <string_view>
#include <utility>

#include "protocols/canopen/wire_bytes.h"

namespace strainwave::protocols::canopen {
namespace {

using std::chrono::nanoseconds;
using Action = CommissioningStep::Action;
using Concern = CommissioningStep::Concern;

bool WritesAllBits(const CommissioningStep& step) {
  return step.mask == (step.bytes >= 4 ? 0xFFFFFFFF : (std::uint32_t{1} << (8 * step.bytes)) - 1);
}

// Of a position of 32 bits with a sign: none is set, or it is where they go over anyway. Some makers write
// the lower one as the upper one's opposite.
bool IsNoEnd(std::uint32_t value) {
  return value == 0 || value == 0x7FFFFFFF || value == 0x80000000 || value == 0x80000001;
}

bool IsAsExpected(const CommissioningStep& step, std::uint32_t read) {
  switch (step.action) {
    case Action::kExpect:
      return (read & step.mask) == step.value;
    case Action::kExpectNot:
      return (read & step.mask) != step.value;
    case Action::kExpectNoEnd:
      return IsNoEnd(read);
    case Action::kWrite:
      break;
  }
  return true;
}

struct TorqueUnit {
  std::string_view name;
  double per_Nm;
};
constexpr TorqueUnit kTorqueUnits[] = {{"Nm", 1.0}, {"Ncm", 100.0}, {"mNm", 1e3}, {"uNm", 1e6}};

std::string_view NameOfUnit(double per_Nm) {
  const auto* const unit = std::ranges::find_if(kTorqueUnits, [per_Nm](const TorqueUnit& known) {
    return std::abs(known.per_Nm / per_Nm - 1.0) < 1e-9;
  });
  return unit == std::end(kTorqueUnits) ? "units" : unit->name;
}

// Short, as the bench keeps 240 bytes. A drive that counts in another unit reads as a motor of a power of ten
// times the torque.
std::string OtherRatedTorque(const std::string& object, const CommissioningStep& step, std::uint32_t read) {
  const std::string_view profiles_unit = NameOfUnit(step.units_per_Nm);
  const std::string both =
      fmt::format("{} is {}, the profile has {:.6g} {}", object, read, step.exact_value, profiles_unit);
  for (const TorqueUnit& unit : kTorqueUnits) {
    const double expected = step.exact_value / step.units_per_Nm * unit.per_Nm;
    // 6076h is a whole number, and a data sheet's three or four digits are not the last word.
    constexpr double kDigits = 1e-3;
    if (unit.per_Nm == step.units_per_Nm || std::abs(read - expected) > 0.5 + kDigits * expected || read == 0)
      continue;
    return fmt::format(
        "{}: they differ by just {:g}; if the drive counts in {}, the profile says so: units: "
        "{{rated_torque_unit: {}}}",
        both, std::max(unit.per_Nm / step.units_per_Nm, step.units_per_Nm / unit.per_Nm), unit.name,
        unit.name);
  }
  return fmt::format(
      "{} (expected rated_torque as on the motor's data sheet, and rated_torque_unit where the drive does "
      "not count in "
      "{})",
      both, profiles_unit);
}

bool HasNoSuchObject(const SdoClient& client) {
  return client.state() == SdoClient::State::kFailed && client.failure().by_node &&
         (client.failure().code == SdoAbort::kNoSuchObject ||
          client.failure().code == SdoAbort::kNoSuchSubindex);
}

}  // namespace

Commissioning::Commissioning(std::vector<CommissioningStep> steps, std::uint8_t node_id,
                             nanoseconds sdo_timeout)
    : steps_(std::move(steps)), node_id_(node_id), client_(node_id, sdo_timeout) {}

void Commissioning::Start(nanoseconds now) noexcept {
  client_.Reset();
  step_ = 0;
  state_ = State::kRunning;
  BeginStep(now);
}

void Commissioning::Abandon() noexcept {
  client_.Reset();
  state_ = State::kIdle;
}

void Commissioning::BeginStep(nanoseconds now) noexcept {
  if (step_ == steps_.size()) {
    state_ = State::kDone;
    return;
  }
  const CommissioningStep& step = steps_[step_];
  if (step.action == Action::kWrite && WritesAllBits(step)) return Write(step.value, now);
  is_writing_ = false;
  (void)client_.StartUpload(step.address, step.bytes, SdoTransfer::kExpeditedOrSegmented, now);
}

void Commissioning::Write(std::uint32_t value, nanoseconds now) noexcept {
  const CommissioningStep& step = steps_[step_];
  std::array<std::uint8_t, 4> bytes{};
  ToLittleEndian(value, bytes);
  is_writing_ = true;
  (void)client_.StartDownload(step.address, std::span(bytes).first(step.bytes),
                              SdoTransfer::kExpeditedOrSegmented, now);
}

void Commissioning::OnTransferDone(nanoseconds now) noexcept {
  const CommissioningStep& step = steps_[step_];
  if (!is_writing_) {
    read_ = static_cast<std::uint32_t>(FromLittleEndian(client_.data()));
    if (step.action == Action::kWrite) return Write((read_ & ~step.mask) | step.value, now);
    if (!IsAsExpected(step, read_)) {
      state_ = State::kFailed;
      return;
    }
  }
  NextStep(now);
}

void Commissioning::NextStep(nanoseconds now) noexcept {
  ++step_;
  BeginStep(now);
}

void Commissioning::OnFrame(const CanFrame& frame, nanoseconds now) noexcept {
  client_.OnFrame(frame, now);
  if (state_ != State::kRunning) return;
  if (client_.state() == SdoClient::State::kDone) return OnTransferDone(now);
  if (client_.state() != SdoClient::State::kFailed) return;
  const bool has_no_end = steps_[step_].action == Action::kExpectNoEnd && HasNoSuchObject(client_);
  if (has_no_end) return NextStep(now);
  state_ = State::kFailed;
}

std::optional<CanFrame> Commissioning::Poll(nanoseconds now) noexcept {
  const std::optional<CanFrame> frame = client_.Poll(now);
  if (state_ == State::kRunning && client_.state() == SdoClient::State::kFailed) state_ = State::kFailed;
  return frame;
}

std::string Commissioning::FailureWords() const {
  if (state_ != State::kFailed) return {};
  const CommissioningStep& step = steps_[step_];
  if (client_.state() == SdoClient::State::kFailed) {
    return fmt::format("{} cannot be {}: {}", step.purpose, is_writing_ ? "written" : "read",
                       Words(client_.failure()));
  }
  const std::string object = fmt::format("{} ({})", step.purpose, Words(step.address));
  const int digits = 2 * step.bytes;
  switch (step.concern) {
    case Concern::kIdentity:
      return fmt::format(
          "node {} is another drive than the profile's, nothing was written to it: {} is "
          "{:0{}X}h (expected {:0{}X}h)",
          node_id_, object, read_ & step.mask, digits, step.value, digits);
    case Concern::kAbility:
      return fmt::format(
          "node {} is not able to do what the profile says: {} is {:0{}X}h (expected {:0{}X}h)", node_id_,
          object, read_ & step.mask, digits, step.value, digits);
    case Concern::kRatedTorque:
      return fmt::format("node {}: {}", node_id_, OtherRatedTorque(object, step, read_));
    case Concern::kSetting:
      return fmt::format("node {} did not take a setting: {} reads {:0{}X}h (written {:0{}X}h)", node_id_,
                         object, read_ & step.mask, digits, step.value, digits);
    case Concern::kSupervision:
      return fmt::format(
          "node {} must not be enabled, it would not notice that the master is gone: {} reads "
          "back as off ({:0{}X}h)",
          node_id_, object, read_, digits);
    case Concern::kEmergencies:
      return fmt::format(
          "node {} says its emergencies where nobody listens: {} is {:0{}X}h (expected {:0{}X}h); let the "
          "profile's objects set it",
          node_id_, object, read_, digits, step.value, digits);
    case Concern::kEndless:
      return fmt::format(
          "node {} counts its position between ends, and a campaign turns the shaft on for weeks: {} is "
          "{:0{}X}h (expected {:0{}X}h: none); let the profile's objects set it",
          node_id_, object, read_, digits, step.value, digits);
  }
  return {};
}

}  // namespace strainwave::protocols::canopen

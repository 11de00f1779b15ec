// SPDX-License-Identifier: Apache-2.0
// What a bench of metal says of itself.
#include <fmt/format.h>

#include "bench/devices/field/field_machine.h"

namespace strainwave::bench {

std::string FieldMachine::MissingForStart() const {
  if (!pendant_) return {};
  const PendantActual actual = pendant_->Actual();
  if (!actual.connected) return "plug the pendant in";
  switch (actual.state) {
    case PendantState::kStopped:
      return "press reset on the pendant, then start";
    case PendantState::kReset:
      return "press start on the pendant";
    case PendantState::kReleased:
      return {};
  }
  return {};
}

std::vector<std::string> FieldMachine::TakeNotes() {
  std::vector<std::string> notes;
  if (sto_contact_) {
    for (const StoOpening& opening : sto_contact_->TakeOpenings()) {
      notes.push_back(opening.latency
                          ? fmt::format("safe torque off opened {:.1f} ms after the stop was asked for",
                                        std::chrono::duration<double, std::milli>(*opening.latency).count())
                          : "safe torque off opened, and nobody had asked for a stop here");
    }
  }
  if (camera_) {
    for (const Snapshot& snapshot : camera_->TakeSnapshots()) {
      notes.push_back(
          snapshot.trouble.empty()
              ? fmt::format("picture {}{}", snapshot.file.filename().string(), snapshot.late ? ", late" : "")
              : fmt::format("no picture {}: {}", snapshot.file.filename().string(), snapshot.trouble));
    }
  }
  return notes;
}

void FieldMachine::TakePicture(const std::filesystem::path& file) {
  if (camera_) camera_->Ask(file.string());
}

std::vector<FieldMachine::DeviceState> FieldMachine::States() const {
  std::vector<DeviceState> states;
  for (const auto& [name, bus] : buses_) {
    if (!bus.served) continue;
    const DriveBusCounts counts = bus.served->counts();
    states.push_back(
        {name, fmt::format("{} frames sent, {} received, {} lost", counts.sent, counts.received, counts.lost),
         counts.lost == 0 && counts.state == CanState::kErrorActive});
    for (std::size_t i = 0; i < bus.served->size(); ++i) {
      CanopenServo& servo = bus.served->servo(i);
      const ServoReport report = servo.report();
      const std::string words = report.words.data();
      const bool good = report.stage == protocols::canopen::DriveStage::kDisabled && words.empty();
      states.push_back({fmt::format("{}, node {}", servo.name(), servo.settings().node_id),
                        words.empty() ? std::string(Name(report.stage)) : words, good});
    }
  }
  if (pendant_) {
    const std::string missing = MissingForStart();
    states.push_back({"pendant", missing.empty() ? "started" : missing, pendant_->Actual().connected});
  }
  for (const auto& [name, hid] : hid_) {
    const bool connected = hid.channels->connected();
    states.push_back({name, connected ? "connected" : "not plugged in", connected});
  }
  for (const auto& [name, client] : modbus_) {
    const std::string trouble = client->trouble();
    states.push_back({name,
                      trouble.empty() ? (client->connected() ? "connected" : "not yet connected") : trouble,
                      trouble.empty() && client->connected()});
  }
  for (const auto& [name, reader] : sources_) {
    const std::string trouble = reader->Trouble();
    const daq::acquisition::GapTotals totals = reader->totals();
    states.push_back(
        {name, trouble.empty() ? fmt::format("{} samples, {} lost", totals.received, totals.lost) : trouble,
         trouble.empty() && totals.received > 0});
  }
  return states;
}

std::string FieldMachine::Troubles() const {
  std::string all;
  for (const DeviceState& state : States()) {
    if (state.good || state.state == Name(protocols::canopen::DriveStage::kStopped)) continue;
    all += fmt::format("{}{}: {}", all.empty() ? "" : "\n", state.device, state.state);
  }
  return all;
}

}  // namespace strainwave::bench

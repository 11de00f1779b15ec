// SPDX-License-Identifier: Apache-2.0
// What a bench of metal says of itself.
#include <optional>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "bench/devices/canopen/bus_troubles.h"
#include "bench/machines/field/field_machine.h"
#include "daq/acquisition/capture_file.h"

namespace strainwave::bench {

namespace {

std::string ConnectionWords(const std::string& trouble, bool connected) {
  if (!trouble.empty()) return trouble;
  return connected ? "connected" : "not yet connected";
}

}  // namespace

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

bool FieldMachine::StartKeyHeld() const {
  if (!pendant_) return false;
  const PendantActual actual = pendant_->Actual();
  return actual.state == PendantState::kReleased && actual.keys.start;
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
  NoteSyncs(notes);
  NoteBusTroubles(notes);
  NoteBusLogs(notes);
  return notes;
}

std::vector<ChannelCalibration> FieldMachine::Calibrations() const {
  std::vector<ChannelCalibration> calibrations;
  for (const ChannelLink& link : bench_.channels) {
    const auto reader = sources_.find(link.device);
    const auto channel = reader == sources_.end() ? std::nullopt : reader->second->Find(link.source);
    if (!channel) continue;
    const auto& description = reader->second->description().channels[*channel];
    calibrations.push_back(
        {link.channel, description.sensor_serial, description.unit, description.calibration});
  }
  return calibrations;
}

std::vector<SourceTotals> FieldMachine::Sources() const {
  std::vector<SourceTotals> all;
  for (const auto& [name, reader] : sources_) {
    all.push_back({name, reader->totals(), reader->clock(), reader->clock_restarts(), reader->Trouble()});
  }
  return all;
}

void FieldMachine::StartRecording(const RecordingRequest& request) {
  constexpr double kFile_s = 3600.0;
  constexpr double kFlush_s = 1.0;
  constexpr double kSlowDisk_s = 4.0;
  for (const std::string& name : request.sources) {
    const auto found = sources_.find(name);
    if (found == sources_.end()) {
      throw std::invalid_argument(fmt::format("source {} is none of the bench's (must be one)", name));
    }
    const auto& source = found->second->description();
    const auto rows = [&](double time_s) { return static_cast<std::uint64_t>(time_s * source.rate_hz) + 1; };
    daq::acquisition::RecorderSettings settings;
    settings.folder = request.folder;
    settings.name = fmt::format("{}-{}", request.name, name);
    settings.most_rows_a_file = rows(kFile_s);
    settings.rows_between_flushes = rows(kFlush_s);
    settings.ring_blocks = rows(kSlowDisk_s) / source.most_samples_a_block + 16;
    settings.attributes = request.attributes;
    found->second->StartRecording(settings);
  }
}

std::vector<RecordedSource> FieldMachine::StopRecording() {
  std::vector<RecordedSource> all;
  for (const auto& [name, reader] : sources_) {
    if (auto recorded = reader->StopRecording()) {
      all.push_back({name, recorded->totals, std::move(recorded->trouble)});
    }
  }
  return all;
}

// Trips that the control loop does not see are marked here, as late as they are told.
void FieldMachine::KeepStreams(const std::filesystem::path& stem, const daq::Attributes& attributes) {
  for (const auto& [name, reader] : sources_) reader->MarkTrip();
  daq::Attributes all = attributes;
  // What the file's times have to have taken off to be those of the record of the fault.
  all.emplace_back("bench_clock_zero_ns", std::to_string(-clock_.FromKernel({}).count()));
  for (const auto& [name, reader] : sources_) {
    const auto around = reader->TakeAroundTrip();
    if (!around) continue;
    daq::acquisition::WriteCapture(fmt::format("{}-{}.h5", stem.string(), name), reader->description(),
                                   *around, all);
  }
}

void FieldMachine::TakePicture(const std::filesystem::path& file) {
  if (camera_) camera_->Ask(file.string());
}

// Point 14 of what is asked of a master: brake and safe torque off are shown. What was so once is not known
// to be so now; who it is was asked at the start.
std::vector<std::pair<std::string, std::string>> FieldMachine::FactsOf(const CanopenServo& servo) const {
  const char* const unknown = "not known";
  const ServoReport report = servo.report();
  const bool torque_off_known = report.heard && report.torque_off_known;
  const auto identity = identities_.find(servo.name());
  return {{"brake", !report.heard          ? unknown
                    : report.brake_engaged ? "on"
                                           : "off"},
          {"safe_torque_off", !torque_off_known          ? unknown
                              : report.torque_safely_off ? "open"
                                                         : "closed"},
          {"identity", identity == identities_.end() ? unknown : identity->second}};
}

// A map of registers names no safe torque off.
std::vector<std::pair<std::string, std::string>> FieldMachine::FactsOf(const ModbusServoDrive& servo) {
  const char* const untold = "not told";
  const std::optional<bool> brake = servo.tells_brake_engaged();
  const std::string identity = servo.identity();
  return {{"brake", !brake   ? "not known"
                    : *brake ? "on"
                             : "off"},
          {"safe_torque_off", untold},
          {"identity", identity.empty() ? untold : identity}};
}

std::vector<FieldMachine::DeviceState> FieldMachine::States() const {
  std::vector<DeviceState> states;
  for (const auto& [name, bus] : buses_) {
    if (!bus.served) continue;
    const DriveBusCounts counts = bus.served->counts();
    const std::vector<std::string> troubles = BusTroubles(counts);
    states.push_back({name,
                      fmt::format("{} frames sent, {} received, {} lost{}{}", counts.sent, counts.received,
                                  counts.lost, troubles.empty() ? "" : "; ", fmt::join(troubles, "; ")),
                      counts.lost == 0 && counts.malformed == 0 && counts.state == CanState::kErrorActive});
    for (std::size_t i = 0; i < bus.served->size(); ++i) {
      CanopenServo& servo = bus.served->servo(i);
      const ServoReport report = servo.report();
      const std::string words = report.words.data();
      const bool good = report.stage == protocols::canopen::DriveStage::kDisabled && words.empty();
      // The words of a trouble name the node.
      if (words.empty()) {
        states.push_back({fmt::format("{}, node {}", servo.name(), servo.settings().node_id),
                          std::string(Name(report.stage)), good, FactsOf(servo)});
      } else {
        states.push_back({servo.name(), words, good, FactsOf(servo)});
      }
    }
  }
  for (const auto& [name, servo] : modbus_servos_) {
    std::string trouble = servo->trouble();
    if (trouble.empty()) trouble = servo->fault();
    const bool good = trouble.empty() && servo->is_supervised();
    states.push_back({name, ConnectionWords(trouble, good), good, FactsOf(*servo)});
  }
  for (const MeasuredStop& stop : stops_) {
    states.push_back({fmt::format("{}, time to stop", stop.servo),
                      fmt::format("left enabled after {:.0f} ms, stood after {:.0f} ms, measured {}",
                                  1e3 * stop.left_enabled_s, 1e3 * stop.stood_s, stop.measured),
                      true});
  }
  if (pendant_) {
    const std::string missing = MissingForStart();
    states.push_back({"pendant", missing.empty() ? "started" : missing, pendant_->Actual().connected});
  }
  if (sto_contact_) {
    const StoActual actual = sto_contact_->Actual();
    states.push_back({"safe torque off contact",
                      !actual.good  ? "not plugged in"
                      : actual.open ? "open"
                                    : "closed",
                      actual.good});
  }
  for (const auto& [name, hid] : hid_) {
    const bool connected = hid.channels->connected();
    states.push_back({name, connected ? "connected" : "not plugged in", connected});
  }
  for (const auto& [name, client] : modbus_) {
    const std::string trouble = client->trouble();
    states.push_back(
        {name, ConnectionWords(trouble, client->connected()), trouble.empty() && client->connected()});
  }
  for (const auto& [name, amplifier] : amplifiers_) {
    const std::string trouble = amplifier->trouble();
    states.push_back(
        {name, ConnectionWords(trouble, amplifier->connected()), trouble.empty() && amplifier->connected()});
  }
  for (const auto& [name, chamber] : chambers_) {
    const std::string trouble = chamber->trouble();
    const bool good = trouble.empty() && chamber->connected();
    const ChannelValue set_point = chamber->SetPoint();
    std::string words = ConnectionWords(trouble, good);
    if (good && set_point.good) words += fmt::format(", set point {:.1f} degC", set_point.value);
    states.push_back({name, words, good});
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

std::string FieldMachine::ReasonOf(const ChannelLink& link) const {
  std::string reason;
  if (const auto source = sources_.find(link.device); source != sources_.end()) {
    const auto channel = source->second->Find(link.source);
    if (channel) reason = source->second->TroubleOf(*channel);
    if (reason.empty() && source->second->Newest().time.count() == 0) reason = "nothing has come of it yet";
  } else if (const auto hid = hid_.find(link.device); hid != hid_.end()) {
    if (!hid->second.channels->connected()) reason = "not plugged in";
  } else if (const auto client = modbus_.find(link.device); client != modbus_.end()) {
    reason = client->second->trouble();
    if (reason.empty() && !client->second->connected()) reason = "not connected";
  } else if (const auto amplifier = amplifiers_.find(link.device); amplifier != amplifiers_.end()) {
    reason = amplifier->second->trouble();
  } else if (const auto chamber = chambers_.find(link.device); chamber != chambers_.end()) {
    reason = chamber->second->trouble();
  }
  if (reason.empty()) reason = "no fresh value, or one outside its limits";
  return reason.starts_with(link.device + ":") ? reason : fmt::format("{}: {}", link.device, reason);
}

std::vector<FieldMachine::BadChannel> FieldMachine::BadChannels() const {
  std::vector<BadChannel> bad;
  for (const auto& [link, read] : links_) {
    if (!read().good) bad.push_back({link->channel, ReasonOf(*link)});
  }
  return bad;
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

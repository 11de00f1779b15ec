// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "bench/roles/bench_devices.h"
#include "bench/roles/channel_calibration.h"
#include "bench/roles/sample_sources.h"

namespace strainwave::bench {

/// One bench as a campaign sees it: its devices, and the little in which a simulated one differs from one
/// made of metal. The defaults are those of metal.
class BenchMachine {
 public:
  BenchMachine() = default;
  BenchMachine(const BenchMachine&) = delete;
  BenchMachine& operator=(const BenchMachine&) = delete;
  virtual ~BenchMachine() = default;

  virtual BenchDevices Devices() = 0;

  /// What the bench itself must be told again after a power cut. On metal the shafts simply stay where they
  /// are, but how often an encoder has gone over its end nobody else knows. The view holds until the next
  /// call.
  virtual std::span<const std::byte> Memory() { return {}; }
  virtual void RestoreMemory(std::span<const std::byte>) {}

  /// A phase begins; `key` is the same whenever this phase of this cycle is run again.
  virtual void BeginPhase(std::uint64_t) {}

  /// The gear is replaced by the rigid blank, or put back. On metal a person does it and confirms.
  virtual void MountBlank(bool mounted) = 0;

  /// What its devices say of the calibration of their channels; one a channel of the bench at most.
  virtual std::vector<ChannelCalibration> Calibrations() const { return {}; }

  /// Its sources of samples, each since it was connected.
  virtual std::vector<SourceTotals> Sources() const { return {}; }
  /// Keeps raw streams from now on. @throws std::invalid_argument for a source that there is not,
  ///   daq::DataFileError where the files cannot be begun.
  virtual void StartRecording(const RecordingRequest&) {}
  /// Ends it; the files are whole when it returns.
  virtual std::vector<RecordedSource> StopRecording() { return {}; }

  /// What is wrong with its devices at the moment, in words, a line each; empty where nothing is.
  virtual std::string Troubles() const { return {}; }

  /// The channels that give no value at the moment, in the order of the bench file.
  struct BadChannel {
    std::string channel;
    std::string reason;  // in words
  };
  virtual std::vector<BadChannel> BadChannels() const { return {}; }

  /// Waits until every channel and drive has given a value: before that there is nothing to judge. Nothing is
  /// enabled meanwhile.
  /// @param given_up  ends it early.
  /// @return what has not come in the time that it may take, in words; empty where all has.
  virtual std::string AwaitValues([[maybe_unused]] const std::function<bool()>& given_up) { return {}; }

  /// What a person must do before anything may move, in words; empty when nothing.
  virtual std::string MissingForStart() const { return {}; }

  /// What speaks against a campaign on this bench, a line each: what `refuses` must be mended first.
  struct Finding {
    bool refuses{};
    std::string words;
  };
  virtual std::vector<Finding> Findings() const { return {}; }

  /// Whether a hand is on the bench's own start key, which then lets a drive be turned by hand.
  virtual bool StartKeyHeld() const { return false; }

  /// What has happened at the bench since the last call and belongs into the journal.
  virtual std::vector<std::string> TakeNotes() { return {}; }

  /// Asks for a picture of the bench, where it has a camera; never waits for it. What became of it is a note.
  virtual void TakePicture(const std::filesystem::path&) {}

  /// Writes down in `folder` what goes over the bench's buses, from now on; bounded, the oldest goes.
  virtual void LogBuses(const std::filesystem::path&) {}
  /// Keeps what was written down around now, under names that begin with `stem`.
  virtual void KeepBusLogs(const std::filesystem::path&) {}

  /// Keeps what its sources of samples sent around the trip, under names that begin with `stem`; waits for
  /// what is still to come. @throws daq::DataFileError where a file cannot be written.
  virtual void KeepStreams(const std::filesystem::path&, const daq::Attributes&) {}

  /// All measurements of a cycle are done; a simulated bench may note the truth it alone knows.
  virtual void CycleMeasured(int) {}
};

}  // namespace strainwave::bench

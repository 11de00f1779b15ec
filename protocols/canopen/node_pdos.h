// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <vector>

#include "protocols/can_frame.h"
#include "protocols/canopen/emergency_producer.h"
#include "protocols/canopen/object_dictionary.h"
#include "protocols/canopen/pdo_slot.h"

namespace strainwave::protocols::canopen::device {

/// All PDOs of a node while it is operational (CiA 301, 7.2.2): RPDOs of type 0 to 240 take effect with the
/// next SYNC, those of 254 and 255 at once; TPDOs go out every n-th SYNC, of type 0 at a SYNC after a change,
/// of 254 and 255 at a change or when the event time has passed, never sooner than the inhibit time.
class NodePdos {
 public:
  NodePdos(ObjectDictionary& objects, EmergencyProducer& emergencies);

  /// Into operational: event TPDOs are due, times begin anew.
  void Start();

  /// @returns whether objects were written.
  bool OnFrame(const CanFrame& frame, std::chrono::nanoseconds now);
  /// Gives effect to what waited for the SYNC; the same answer.
  bool OnSync();
  /// Samples the TPDOs that this SYNC asks for; the node has read its sensors by now.
  void SampleOnSync();
  /// Looks at the event times of the RPDOs.
  void Supervise(std::chrono::nanoseconds now);
  /// Samples the TPDOs that are due by an event or by their event time.
  void SampleOnEvent(std::chrono::nanoseconds now);
  bool Next(CanFrame& frame);

  /// An RPDO with an event time (1400h:5) that came once comes no more.
  bool timed_out() const;

  /// Of a fault put in: each TPDO is this much longer or shorter than its mapping.
  void set_length_change(int bytes) { length_change_ = bytes; }

 private:
  struct Receive {
    std::unique_ptr<PdoSlot> slot;
    CanFrame waiting;
    bool waits{};
    bool heard{};
    bool timed_out{};
    std::chrono::nanoseconds last{};
  };
  struct Transmit {
    std::unique_ptr<PdoSlot> slot;
    CanFrame sampled;
    CanFrame last;
    bool due{};
    bool first{true};  // since the node became operational
    int syncs{};
    std::chrono::nanoseconds last_time{};
  };

  void Sample(Transmit& transmit);

  EmergencyProducer& emergencies_;
  std::vector<Receive> receive_;
  std::vector<Transmit> transmit_;
  int length_change_{};
};

}  // namespace strainwave::protocols::canopen::device

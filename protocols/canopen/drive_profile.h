// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "protocols/canopen/drive_units.h"
#include "protocols/canopen/eds_file.h"
#include "protocols/canopen/file_note.h"
#include "protocols/canopen/object.h"
#include "protocols/canopen/pdo.h"
#include "protocols/cia402_modes.h"

namespace strainwave::protocols::canopen {

/// Object 1018h; 0 takes any.
struct DriveIdentity {
  std::uint32_t vendor{};
  std::uint32_t product{};
  std::uint32_t revision{};
};

/// Who watches whom, and for how long a silence is borne.
struct Supervision {
  std::uint8_t master_node_id{127};
  std::uint16_t drive_heartbeat_ms{50};          // 1017h
  std::uint16_t drive_timeout_ms{150};           // the master's patience with the drive
  std::uint16_t master_heartbeat_ms{50};         // what the master sends
  std::uint16_t master_timeout_ms{150};          // 1016h:01, the drive's patience with the master
  std::uint8_t communication_error_behaviour{};  // 1029h:01: 0 pre-operational, 1 none (off), 2 stopped
  std::uint16_t rpdo_event_timer_ms{50};         // 14xxh:05 of the controlword's PDO
};

/// What the drive does by itself, by the codes of IEC 61800-7-201.
struct OptionCodes {
  std::int16_t abort_connection{3};   // 6007h: 0 nothing (off), 1 fault, 2 disable voltage, 3 quick stop
  std::int16_t quick_stop{2};         // 605Ah: 2 down the quick stop ramp, then voltage off
  std::int16_t shutdown{0};           // 605Bh
  std::int16_t disable_operation{1};  // 605Ch: 1 down the ramp, then voltage off
  std::int16_t halt{1};               // 605Dh
  std::int16_t fault_reaction{2};     // 605Eh
};

/// At the axis, in SI. All above zero.
struct DriveLimits {
  double max_speed_rad_per_s{};
  double max_torque_Nm{};
  double acceleration_rad_per_s2{};             // 6083h, 6084h, and the ramp of cyclic velocity
  double quick_stop_deceleration_rad_per_s2{};  // 6085h
  double following_error_window_rad{};          // 6065h
  std::uint16_t following_error_time_ms{};      // 6066h; zero: at once
  double standstill_speed_rad_per_s{};          // below it a shaft stands
};

/// Where a yes or no is found.
struct BitSource {
  enum class From : std::uint8_t { kNowhere, kStatusword, kDigitalInputs };  // 6041h, 60FDh
  From from{From::kNowhere};
  std::uint32_t mask{};
  bool is_low_active{};
};

/// How the holding brake is commanded, where the drive does not do it by itself.
struct BrakeControl {
  enum class By : std::uint8_t { kDrive, kControlword, kDigitalOutput };  // none, 6040h, 60FEh:01
  By by{By::kDrive};
  std::uint32_t mask{};
  bool engages_when_high{};     // else the bit releases, so that zero is safe
  bool waits_for_standstill{};  // a stop engages it once the shaft stands, not at once
  BitSource engaged_feedback{};
};

/// One more object to write or to check at start, of an integer type of at most 32 bits.
struct ProfileObject {
  enum class Action : std::uint8_t { kWrite, kWriteAndReadBack, kExpect };
  ObjectAddress address;
  DataType type{};
  std::int64_t value{};
  Action action{Action::kWriteAndReadBack};
  std::string purpose;
};

struct DriveTiming {
  std::chrono::nanoseconds sync_period{std::chrono::milliseconds(4)};
  std::chrono::nanoseconds most_sync_deviation{std::chrono::milliseconds(4)};
  /// Behind steadily moving set points, besides the time until it gets them; zero with feed-forward.
  std::chrono::nanoseconds position_loop_lag{};
  unsigned stale_after_syncs{5};  // a TPDO older than this is stale
  std::chrono::nanoseconds sdo_timeout{std::chrono::milliseconds(500)};
  std::chrono::nanoseconds start_timeout{std::chrono::seconds(1)};         // NMT start to PDOs
  std::chrono::nanoseconds stage_timeout{std::chrono::milliseconds(800)};  // one power state on the way up
  std::chrono::nanoseconds mode_timeout{std::chrono::milliseconds(400)};   // 6060h until 6061h shows it
  std::chrono::nanoseconds stop_timeout{std::chrono::seconds(2)};  // quick stop until voltage is cut anyway
  std::chrono::nanoseconds reset_hold{std::chrono::milliseconds(20)};  // each level of the reset edge
};

/// In what a drive departs from the standard.
struct DriveQuirks {
  std::vector<std::uint16_t>
      absent_objects;  // indices that are neither written nor read: the drive lacks them
  std::vector<std::uint16_t> warning_codes;  // EMCY codes that are told but do not stop
  bool lacks_rpdo_event_timer{};             // 14xxh:05: it cannot notice missing set-points
  bool lacks_tpdo_event_timer{};             // 18xxh:05: its statusword comes with SYNC
};

/// One type of drive, as a file describes it.
struct DriveProfile {
  std::string name;
  DriveIdentity identity;
  std::vector<OperationMode> modes;  // all must be in 6502h
  DriveUnits units;
  DriveLimits limits;
  Supervision supervision;
  OptionCodes option_codes;
  BrakeControl brake;
  BitSource safe_torque_off;
  std::vector<ProfileObject> objects;
  /// COB-IDs without the node's number, which is added. Empty: `StandardPdos`.
  std::vector<PdoSetting> pdos;
  DriveTiming timing;
  DriveQuirks quirks;
  std::vector<std::string> eds_notes;  // what is odd about the maker's EDS file, with its places
};

bool IsAbsent(const DriveProfile& profile, std::uint16_t index) noexcept;

/// Controlword and mode by event and watched by the drive, set-points with SYNC; statusword by event, so that
/// no state is missed, and actual values with SYNC. A drive that cannot repeat its statusword by itself sends
/// it with SYNC, too; without 603Fh among its objects it tells errors by EMCY alone.
std::vector<PdoSetting> StandardPdos(const DriveProfile& profile);

/// The PDOs of the profile for this node.
std::vector<PdoSetting> PdosOf(const DriveProfile& profile, std::uint8_t node_id);

/// What is wrong with the profile by itself, in words, one finding each; empty when nothing is.
std::vector<std::string> CheckProfile(const DriveProfile& profile);

/// What of a sound profile the drive cannot do according to its maker: every object that is written, read or
/// mapped exists, allows it, has the profile's length, and takes the value. Each at its place in the EDS: of
/// the value that does not fit, else of the object's section; 1:1 where there is none.
std::vector<FileNote> CheckProfileAgainstEds(const DriveProfile& profile, const EdsFile& eds,
                                             std::uint8_t node_id);

}  // namespace strainwave::protocols::canopen

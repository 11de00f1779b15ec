// SPDX-License-Identifier: Apache-2.0
#include "bench/configuration/drive_profile_draft.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "protocols/canopen/commissioning_steps.h"
#include "protocols/canopen/drive_profile.h"
#include "protocols/canopen/type_limits.h"

namespace strainwave::bench {
namespace {

using protocols::OperationMode;
using protocols::canopen::CommissioningStep;
using protocols::canopen::CommissioningSteps;
using protocols::canopen::DriveProfile;
using protocols::canopen::EdsFile;
using protocols::canopen::EdsObject;
using protocols::canopen::ObjectAddress;

constexpr std::uint8_t kNodeOfDraft = 1;  // what depends on the node's number is not asked for
constexpr std::uint32_t kMaxon = 0xFB;
constexpr std::size_t kCommentColumn = 44;

// By use: the bench turns shafts in the cyclic modes where a drive has them.
constexpr std::pair<OperationMode, std::string_view> kModeWords[] = {
    {OperationMode::kCyclicVelocity, "csv"}, {OperationMode::kCyclicPosition, "csp"},
    {OperationMode::kCyclicTorque, "cst"},   {OperationMode::kProfilePosition, "pp"},
    {OperationMode::kProfileVelocity, "pv"}, {OperationMode::kProfileTorque, "tq"},
    {OperationMode::kHoming, "homing"}};

std::string QuotedForYaml(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c < ' ' || c == '\x7F' ? '?' : c;
  }
  return quoted + '"';
}

// A maker's name is in any encoding.
std::string Ascii(std::string_view text) {
  std::string ascii(text);
  std::ranges::replace_if(
      ascii, [](char c) { return c < ' ' || c > '~'; }, '?');
  return ascii;
}

const EdsObject* Find(const EdsFile& eds, ObjectAddress address) {
  const auto found = eds.objects.find(address);
  return found == eds.objects.end() ? nullptr : &found->second;
}

std::optional<std::int64_t> ValueOf(const EdsFile& eds, ObjectAddress address) {
  const EdsObject* object = Find(eds, address);
  if (object == nullptr || object->default_value.empty()) return std::nullopt;
  return protocols::canopen::TypedEdsNumber(object->default_value, kNodeOfDraft, object->type);
}

std::string Source(const EdsObject& object) {
  return object.is_set_for_node ? "as the DCF sets it" : "the file's default";
}

std::string Words(ObjectAddress address) {
  return address.subindex == 0 ? fmt::format("{:04X}h", address.index)
                               : fmt::format("{:04X}h:{:02X}", address.index, address.subindex);
}

// "607Fh is 5000, the file's default"; what is missing is said, too.
std::string Told(const EdsFile& eds, ObjectAddress address) {
  const EdsObject* object = Find(eds, address);
  if (object == nullptr) return fmt::format("{} is not in the file", Words(address));
  if (object->default_value.empty()) return fmt::format("the file gives {} no value", Words(address));
  return fmt::format("{} is {}, {}", Words(address), Ascii(object->default_value), Source(*object));
}

// The same with what the object takes, in its own units.
std::string ToldWithLimits(const EdsFile& eds, ObjectAddress address) {
  const EdsObject* object = Find(eds, address);
  if (object == nullptr || (object->low_limit.empty() && object->high_limit.empty()))
    return Told(eds, address);
  const auto limit = [](const std::string& text) { return text.empty() ? "any" : Ascii(text); };
  return fmt::format("{}; it takes {} to {}", Told(eds, address), limit(object->low_limit),
                     limit(object->high_limit));
}

// A unit of speed or acceleration by CiA 303-2: a power of ten, numerator and denominator, a byte each.
struct SiUnit {
  double per_rpm{};  // or per rpm/s
  std::string_view name;
  int power_of_ten{};
};

std::optional<SiUnit> SiUnitOf(std::int64_t number) {
  struct Known {
    std::int64_t code;
    double per_rpm;
    std::string_view name;
  };
  constexpr Known kKnown[] = {{0xB447, 1.0, "rpm"}, {0xB403, 1.0 / 60.0, "turns/s"}, {0xC003, 1.0, "rpm/s"}};
  if ((number & 0xFF) != 0) return std::nullopt;
  const int power = static_cast<std::int8_t>((number >> 24) & 0xFF);
  for (const Known& known : kKnown) {
    if (((number >> 8) & 0xFFFF) == known.code)
      return SiUnit{known.per_rpm * std::pow(10.0, -power), known.name, power};
  }
  return std::nullopt;
}

class Draft {
 public:
  Draft(const EdsFile& eds, std::string_view eds_key) : eds_(eds), eds_key_(eds_key) {}

  DriveProfileDraft Make() {
    Head();
    Modes();
    Units();
    Limits();
    FindLacks();
    Rest();
    return std::move(draft_);
  }

 private:
  void Line(std::string_view line, std::string_view comment = {}) {
    if (comment.empty()) {
      draft_.text += fmt::format("{}\n", line);
    } else {
      draft_.text += fmt::format("{:<{}}  # {}\n", line, kCommentColumn, comment);
    }
  }
  void Open(std::string_view section, std::string_view key, std::string_view comment) {
    draft_.to_fill_in.push_back(fmt::format("{}.{}", section, key));
    Line(fmt::format("  {}: {}", key, kToBeFilledIn), comment);
  }
  void ExpectInDrive(ObjectAddress address, std::string_view purpose) {
    const EdsObject* object = Find(eds_, address);
    if (object == nullptr || object->type != protocols::canopen::DataType::kUnsigned32) return;
    expected_ += fmt::format(
        "  - {{index: 0x{:04X}, subindex: {}, type: unsigned32, value: {}, action: expect, purpose: {}}}\n",
        address.index, address.subindex, *ValueOf(eds_, address), purpose);
  }

  void Head() {
    Line(
        fmt::format("# A profile to start from, made of {}. Replace every '{}': the profile is refused until",
                    Ascii(eds_key_), kToBeFilledIn));
    Line("# then. Speeds, torques and angles are those of the motor's shaft.");
    Line("drive_profile: 1");
    std::string name = Ascii(eds_.vendor_name);
    if (!name.empty() && !eds_.product_name.empty()) name += ' ';
    name += Ascii(eds_.product_name);
    Line(fmt::format("name: {}", QuotedForYaml(name.empty() ? Ascii(eds_key_) : name)));
    Line(fmt::format("eds: {}", QuotedForYaml(eds_key_)), "this profile is checked against it");
    Line("");
    Line("identity:");
    Identity("vendor", eds_.vendor_number, 1);
    Identity("product", eds_.product_number, 2);
    Identity("revision", eds_.revision_number, 3);
    Line("");
  }

  void Identity(std::string_view key, std::optional<std::uint32_t> number, std::uint8_t subindex) {
    if (number && *number != 0)
      return Line(fmt::format("  {}: 0x{:08X}", key, *number), "of the file's [DeviceInfo]");
    const auto value = ValueOf(eds_, {0x1018, subindex});
    if (value && *value > 0 && *value <= 0xFFFFFFFF) {
      return Line(fmt::format("  {}: 0x{:08X}", key, *value),
                  fmt::format("1018h:{:02X}, {}", subindex, Source(*Find(eds_, {0x1018, subindex}))));
    }
    Line(fmt::format("  {}: 0", key), "any: the file does not say");
  }

  void Modes() {
    constexpr ObjectAddress kSupportedModes{0x6502, 0};
    std::vector<std::string_view> used;
    std::vector<std::string_view> others;
    const std::int64_t supported = ValueOf(eds_, kSupportedModes).value_or(0);
    for (const auto& [mode, word] : kModeWords) {
      if ((supported & protocols::SupportedModeBit(mode)) == 0) continue;
      const bool is_cyclic = word.starts_with('c');
      if (!is_cyclic && !used.empty() && used.front().starts_with('c')) {
        others.push_back(word);
      } else {
        used.push_back(word);
        trial_.modes.push_back(mode);
      }
    }
    if (used.empty()) {
      draft_.to_fill_in.emplace_back("modes");
      Line(fmt::format("modes: [{}]", kToBeFilledIn), Told(eds_, kSupportedModes));
      trial_.modes = {OperationMode::kCyclicVelocity};
    } else {
      Line(fmt::format("modes: [{}]", fmt::join(used, ", ")),
           fmt::format("{}{}", Told(eds_, kSupportedModes),
                       others.empty() ? "" : fmt::format("; it has {}, too", fmt::join(others, ", "))));
    }
    Line("");
  }

  void Units() {
    Line("units:");
    Counts();
    SpeedUnit("velocity_units_per_rpm", {0x60A9, 0}, "unit of speed");
    SpeedUnit("acceleration_units_per_rpm_per_s", {0x60AA, 0}, "unit of acceleration");
    const bool is_micro =
        eds_.vendor_number == kMaxon && eds_.product_name.find("EPOS4") != std::string::npos;
    const double per_Nm = is_micro ? 1e6 : 1e3;
    constexpr ObjectAddress kRatedTorque{0x6076, 0};
    const EdsObject* rated = Find(eds_, kRatedTorque);
    const auto value = ValueOf(eds_, kRatedTorque);
    if (rated != nullptr && rated->is_set_for_node && value && *value > 0) {
      Line(fmt::format("  rated_torque: {:g} Nm", static_cast<double>(*value) / per_Nm),
           Told(eds_, kRatedTorque));
    } else {
      Open("units", "rated_torque", "of the motor's data sheet; " + Told(eds_, kRatedTorque));
    }
    Line(fmt::format("  rated_torque_unit: {}", is_micro ? "uNm" : "mNm"),
         is_micro ? "of 6076h, as EPOS4 drives count it" : "of 6076h, by the standard");
    Line("");
  }

  // Gear and feed, where a drive has them, change what 6064h counts; then 608Fh alone does not tell.
  void Counts() {
    constexpr ObjectAddress kIncrements{0x608F, 1};
    constexpr ObjectAddress kTurns{0x608F, 2};
    const auto increments = ValueOf(eds_, kIncrements);
    const auto turns = ValueOf(eds_, kTurns);
    const bool is_scaled = Find(eds_, {0x6091, 1}) != nullptr || Find(eds_, {0x6092, 1}) != nullptr;
    const bool is_set =
        increments && turns && *increments > 0 && *turns > 0 && Find(eds_, kIncrements)->is_set_for_node;
    if (is_set && !is_scaled) {
      Line(
          fmt::format("  counts_per_rev: {}", static_cast<double>(*increments) / static_cast<double>(*turns)),
          Told(eds_, kIncrements));
      ExpectInDrive(kIncrements, "increments of the encoder");
      ExpectInDrive(kTurns, "turns of the motor for them");
      return;
    }
    Open("units", "counts_per_rev",
         fmt::format("of the motor's shaft, in units of 6064h; {}{}", Told(eds_, kIncrements),
                     is_scaled ? "; 6091h and 6092h scale it" : ""));
  }

  void SpeedUnit(std::string_view key, ObjectAddress address, std::string_view purpose) {
    const auto value = ValueOf(eds_, address);
    const auto unit = value ? SiUnitOf(*value) : std::nullopt;
    const bool is_acceleration = address.index == 0x60AA;
    if (!unit || (unit->name == "rpm/s") != is_acceleration) {
      return Open("units", key,
                  is_acceleration ? "units of 6083h for 1 rpm/s; " + Told(eds_, address)
                                  : "units of 606Ch for 1 rpm; " + Told(eds_, address));
    }
    Line(fmt::format("  {}: {}", key, unit->per_rpm),
         fmt::format("{}, which is 10^{} {}", Told(eds_, address), unit->power_of_ten, unit->name));
    ExpectInDrive(address, purpose);
  }

  void Limits() {
    Line("limits:", "yours, not the drive's; in words what the file says of the same object");
    Open("limits", "speed", "as in 3000 rpm; " + ToldWithLimits(eds_, {0x607F, 0}));
    Open("limits", "torque", "as in 2.5 Nm; " + ToldWithLimits(eds_, {0x6072, 0}));
    Open("limits", "acceleration", "as in 5000 rad/s2; " + ToldWithLimits(eds_, {0x6083, 0}));
    Open("limits", "quick_stop_deceleration", "as in 5000 rad/s2; " + ToldWithLimits(eds_, {0x6085, 0}));
    Open("limits", "following_error_window", "as in 10 deg; " + ToldWithLimits(eds_, {0x6065, 0}));
    Open("limits", "following_error_time", "as in 50 ms; " + ToldWithLimits(eds_, {0x6066, 0}));
    Line("  standstill_speed: 5 rpm", "the usual value");
    Line("");
  }

  // What the drive lacks, by trying the rest of the profile on the file: values of limits are not known yet.
  void FindLacks() {
    trial_.units = {1000.0, 1.0, 1.0, 1.0, 1000.0, 1.0, 1};
    trial_.limits = {1.0, 1.0, 1.0, 1.0, 1.0, 1, 1.0};
    trial_.name = "trial";
    constexpr std::uint16_t kOfLimits[] = {0x6065, 0x6066, 0x6072, 0x607F, 0x6081, 0x6083, 0x6084, 0x6085};
    EdsFile without_limits = eds_;
    for (auto& [address, object] : without_limits.objects) {
      if (std::ranges::find(kOfLimits, address.index) == std::end(kOfLimits)) continue;
      object.low_limit.clear();
      object.high_limit.clear();
    }
    ChooseOptionCodes();
    const auto has = [&](std::uint16_t index) {
      const auto found = eds_.objects.lower_bound({index, 0});
      return found != eds_.objects.end() && found->first.index == index;
    };
    trial_.quirks.lacks_rpdo_event_timer = has(0x1400) && Find(eds_, {0x1400, 5}) == nullptr;
    trial_.quirks.lacks_tpdo_event_timer = has(0x1800) && Find(eds_, {0x1800, 5}) == nullptr;
    constexpr ObjectAddress kErrorCode{0x603F, 0};
    if (const EdsObject* code = Find(eds_, kErrorCode); code == nullptr || !code->mappable) {
      trial_.quirks.absent_objects.push_back(kErrorCode.index);
      absent_.emplace_back(kErrorCode.index, "error code in a PDO: emergency messages tell it alone");
    }
    for (const CommissioningStep& step : CommissioningSteps(trial_, kNodeOfDraft)) {
      const std::uint16_t index = step.address.index;
      const bool is_pdo = index >= 0x1400 && index < 0x1C00;
      if (is_pdo || has(index) || protocols::canopen::IsAbsent(trial_, index)) continue;
      if (step.action == CommissioningStep::Action::kExpectNoEnd) continue;
      DriveProfile without = trial_;
      without.quirks.absent_objects.push_back(index);
      if (!CheckProfile(without).empty()) continue;
      trial_ = std::move(without);
      absent_.emplace_back(index, step.purpose);
    }
    draft_.findings = CheckProfileAgainstEds(trial_, without_limits, kNodeOfDraft);
  }

  // Where the drive does not take the program's own. What is to happen when the master is gone, at a quick
  // stop and at a fault is for a person to say.
  void ChooseOptionCodes() {
    const auto choose = [this](std::string_view key, std::uint16_t index, std::int16_t& code) {
      const EdsObject* object = Find(eds_, {index, 0});
      const auto own = ValueOf(eds_, {index, 0});
      if (object == nullptr || !own) return;
      const auto low = protocols::canopen::TypedEdsNumber(object->low_limit, kNodeOfDraft, object->type);
      const auto high = protocols::canopen::TypedEdsNumber(object->high_limit, kNodeOfDraft, object->type);
      const bool fits = (!low || code >= *low) && (!high || code <= *high);
      const bool own_fits = *own >= -0x8000 && *own <= 0x7FFF;
      if (fits || !own_fits) return;
      option_codes_.emplace_back(
          fmt::format("  {}: {}", key, *own),
          fmt::format("{}; the program's {} is outside the file's limits", Told(eds_, {index, 0}), code));
      code = static_cast<std::int16_t>(*own);
    };
    choose("shutdown", 0x605B, trial_.option_codes.shutdown);
    choose("disable_operation", 0x605C, trial_.option_codes.disable_operation);
    choose("halt", 0x605D, trial_.option_codes.halt);
  }

  void Rest() {
    if (!option_codes_.empty()) {
      Line("option_codes:");
      for (const auto& [line, comment] : option_codes_) Line(line, comment);
      Line("");
    }
    if (!absent_.empty() || trial_.quirks.lacks_rpdo_event_timer || trial_.quirks.lacks_tpdo_event_timer) {
      Line("quirks:", "what the program sets or reads at a start, and the file does not have");
      if (!absent_.empty()) {
        Line("  absent_objects:");
        for (const auto& [index, purpose] : absent_) Line(fmt::format("    - 0x{:04X}", index), purpose);
      }
      if (trial_.quirks.lacks_rpdo_event_timer)
        Line("  lacks_rpdo_event_timer: true", "1400h:05: missing set points go unnoticed in the drive");
      if (trial_.quirks.lacks_tpdo_event_timer)
        Line("  lacks_tpdo_event_timer: true", "1800h:05: the statusword comes with SYNC");
      Line("");
    }
    if (!expected_.empty()) {
      Line("objects:", "the units above, which the drive must be set to");
      draft_.text += expected_ + "\n";
    }
    if (!draft_.findings.empty()) {
      Line(
          "# Not possible with this drive as its file has it (line and column there); the profile is refused "
          "until it says otherwise:");
      for (const auto& finding : draft_.findings)
        Line(fmt::format("#   {}:{}: {}", finding.line, finding.column, Ascii(finding.what)));
      Line("");
    }
    Line(
        "# supervision, option_codes, timing and pdos are the program's own; brake and safe_torque_off "
        "depend on");
    Line("# the wiring. strainwave_drive.yaml, beside the other profiles, shows every section.");
  }

  const EdsFile& eds_;
  std::string_view eds_key_;
  DriveProfileDraft draft_;
  DriveProfile trial_;
  std::string expected_;
  std::vector<std::pair<std::uint16_t, std::string>> absent_;
  std::vector<std::pair<std::string, std::string>> option_codes_;  // lines and their comments
};

}  // namespace

DriveProfileDraft DraftDriveProfile(const EdsFile& eds, std::string_view eds_key) {
  return Draft(eds, eds_key).Make();
}

}  // namespace strainwave::bench

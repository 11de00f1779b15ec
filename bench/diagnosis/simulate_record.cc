// SPDX-License-Identifier: Apache-2.0
#include "bench/diagnosis/simulate_record.h"

#include <algorithm>
#include <filesystem>
#include <stdexcept>

#include <fmt/format.h>

#include "analysis/units.h"
#include "bench/devices/simulated/noise_source.h"
#include "bench/diagnosis/extended_model.h"
#include "bench/diagnosis/make_study.h"
#include "bench/diagnosis/nominal_models.h"
#include "bench/diagnosis/simulate_motion.h"
#include "bench/errors/bench_error.h"
#include "bench/records/record_data.h"
#include "daq/record_rules.h"

namespace strainwave::bench {
namespace {

namespace diagnosis = analysis::diagnosis;
using daq::Record;
using diagnosis::ParameterValue;

constexpr std::uint64_t kNoiseStream = 0x73696D;  // "sim"

// The study's own names decide: of a joint fit the model may have offsets for more records than are
// simulated, and a nominal model by name none for channels that only the record knows.
std::vector<ParameterValue> NominalFor(const RunnableModel& model, const diagnosis::Study& study) {
  const std::vector<double> weights(study.measured().size(), 1.0);
  const diagnosis::ModelFit fit = study.Fit({}, weights, nullptr, diagnosis::FitPurpose::kCompare);
  std::vector<ParameterValue> nominal;
  for (ParameterValue parameter : fit.nominal) {
    const auto known = std::ranges::find(model.nominal, parameter.name, &ParameterValue::name);
    if (known != model.nominal.end()) parameter.value = known->value;
    nominal.push_back(std::move(parameter));
  }
  return nominal;
}

void AddNoise(double deviation, std::uint64_t seed, std::vector<double>& response) {
  NoiseSource source(NoiseKey(seed, kNoiseStream));
  for (double& value : response) value += deviation * source();
}

void ExpectRows(const Record& record, const std::vector<double>& response, std::size_t channels = 1) {
  if (response.size() == channels * record.rows()) return;
  throw std::invalid_argument(
      fmt::format("the record cannot be simulated row by row: the model has {} values for {} rows (expected "
                  "even time stamps without gaps)",
                  response.size(), channels * record.rows()));
}

// Output = input / ratio − error; the angles of the record keep their zero.
void SetSweep(Record& record, const std::vector<double>& error_rad) {
  ExpectRows(record, error_rad);
  const auto input_deg = record.Doubles("input_angle_deg");
  const double ratio = *daq::MetadataNumber(record, "ratio");
  const bool absolute = record.Metadata("absolute") == "true";
  const double input_zero_deg = absolute ? 0.0 : input_deg.front();
  const double output_zero_deg = absolute ? 0.0 : record.Doubles("output_angle_deg").front();
  std::vector<double> output_deg(error_rad.size());
  for (std::size_t i = 0; i < error_rad.size(); ++i) {
    output_deg[i] = output_zero_deg + (input_deg[i] - input_zero_deg) / ratio - DegFromRad(error_rad[i]);
  }
  record.SetColumn("output_angle_deg", std::move(output_deg));
}

void SetLoop(Record& record, const std::vector<double>& twist_rad) {
  ExpectRows(record, twist_rad);
  const double zero_deg =
      record.Metadata("absolute") == "true" ? 0.0 : record.Doubles("output_angle_deg").front();
  std::vector<double> output_deg;
  for (const double twist : twist_rad) output_deg.push_back(zero_deg + DegFromRad(twist));
  record.SetColumn("output_angle_deg", std::move(output_deg));
}

void SetMotion(Record& record, std::vector<double> torque) {
  ExpectRows(record, torque);
  const std::string drive = daq::IsLinearAxis(record) ? "force_N" : "torque_Nm";
  if (record.FindColumn(drive) == nullptr) {
    const double gain = *daq::CurrentGain(record);
    for (double& value : torque) value /= gain;
    record.SetColumn("current_A", std::move(torque));
    return;
  }
  record.SetColumn(drive, std::move(torque));
}

// A study scales channels so that all have one noise; the scale is that of what it made of the record.
void SetVibration(Record& record, const diagnosis::Study& study, const std::vector<double>& values) {
  const std::vector<std::string> channels = VibrationChannelsOf(record);
  ExpectRows(record, values, channels.size());
  const std::size_t rows = record.rows();
  for (std::size_t c = 0; c < channels.size(); ++c) {
    const std::vector<double> before = record.CopyAsDoubles(channels[c]);
    double product = 0.0;
    double square = 0.0;
    for (std::size_t i = 0; i < rows; ++i) {
      product += before[i] * study.measured()[c * rows + i];
      square += before[i] * before[i];
    }
    const double scale = product > 0.0 ? product / square : 1.0;
    std::vector<double> after;
    for (std::size_t i = 0; i < rows; ++i) after.push_back(values[c * rows + i] / scale);
    record.SetColumn(channels[c], std::move(after));
  }
}

}  // namespace

RunnableModel ReadRunnableModel(const std::string& name, bool with_nuisance_terms) {
  if (const std::optional<StudyKind> kind = StudyKindOf(daq::RecordKind::Named(name)))
    return {*kind, NominalParameters(*kind), {}, NominalNoise(*kind)};
  if (!std::filesystem::exists(name)) {
    throw BenchError(
        ExitCode::kWrongInput,
        fmt::format("{}: error: there is no such model (expected {}, or an extended_model.yaml that diagnose "
                    "has written)",
                    name, kDiagnosedKinds));
  }
  const ExtendedModel model = ReadExtendedModel(name);
  if (model.kind == StudyKind::kCampaign) {
    throw BenchError(ExitCode::kWrongInput,
                     fmt::format("{}: error: the model of a campaign makes no record (expected one of {})",
                                 name, kDiagnosedKinds));
  }
  return {model.kind, model.nominal, NamedCausesOf(model, with_nuisance_terms), model.noise_floor};
}

Record ExcitationFor(const RunnableModel& model) {
  ExcitationColumns columns;
  for (const auto& cause : model.causes) {
    for (const ParameterValue& parameter : cause.parameters) {
      columns.temperature = columns.temperature || parameter.name.ends_with("_per_K");
      columns.torque = columns.torque || parameter.name.ends_with("_per_Nm");
    }
  }
  return UsualExcitation(model.kind, columns);
}

Record SimulateRecord(const RunnableModel& model, const Record& like, std::uint64_t seed, bool noise) {
  if (StudyKindOf(like.kind) != model.kind) {
    throw std::invalid_argument(
        fmt::format("the record is of kind {}, the model of kind {} (expected one kind)", like.kind.name(),
                    NameOf(model.kind)));
  }
  Record record = like;
  const auto study = MakeStudy({&like, 1});
  const std::vector<ParameterValue> nominal = NominalFor(model, *study);
  const double deviation = noise ? model.noise / study->unit_per_si() : 0.0;
  if (model.kind == StudyKind::kMotion) {
    std::vector<double> torque = SimulateMotion(like, *study, nominal, model.causes);
    AddNoise(deviation, seed, torque);
    SetMotion(record, std::move(torque));
  } else {
    const Eigen::VectorXd predicted = study->Predict(nominal, model.causes);
    std::vector<double> response(predicted.data(), predicted.data() + predicted.size());
    AddNoise(deviation, seed, response);
    if (model.kind == StudyKind::kTransmissionError) {
      SetSweep(record, response);
    } else if (model.kind == StudyKind::kHysteresis) {
      SetLoop(record, response);
    } else {
      SetVibration(record, *study, response);
    }
  }
  for (daq::Column& column : record.columns) {
    column.sensor_serial.clear();
    column.calibration.clear();
  }
  return record;
}

}  // namespace strainwave::bench

// SPDX-License-Identifier: Apache-2.0
#include "analysis/model/plant_model.h"

#include <limits>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

namespace strainwave::analysis::model::model_plant_model_test {
namespace {

std::string MessageOf(const PlantModel& model) {
  try {
    CompilePlantModel(model);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "no error";
}

PlantParameters Without(std::string_view term) {
  PlantModel model = DefaultPlantModel();
  FindTerm(model, term).enabled = false;
  return CompilePlantModel(model);
}

TEST(PlantModel, CompilesItsDefaultsToTheDefaultsOfTheTerms) {
  const PlantParameters compiled = CompilePlantModel(DefaultPlantModel());
  const PlantParameters plain;
  EXPECT_EQ(compiled.spring.k3_Nm_per_rad, plain.spring.k3_Nm_per_rad);
  EXPECT_EQ(compiled.kinematic.amplitude_rad, plain.kinematic.amplitude_rad);
  EXPECT_EQ(compiled.friction.coulomb_Nm, plain.friction.coulomb_Nm);
  EXPECT_EQ(compiled.output_encoder.graduation_rad, plain.output_encoder.graduation_rad);
  EXPECT_TRUE(compiled.has_resonance);
}

TEST(PlantModel, TakesChangedNumbers) {
  PlantModel model = DefaultPlantModel();
  FindParameter(model, "torsion_spring", "k2_Nm_per_rad") = 2.0e4;
  FindParameter(model, "creep", "share_per_decade") = 0.02;
  const PlantParameters compiled = CompilePlantModel(model);
  EXPECT_EQ(compiled.spring.k2_Nm_per_rad, 2.0e4);
  EXPECT_EQ(compiled.creep.share_per_decade, 0.02);
}

TEST(PlantModel, CarriesUnitsWithItsParameters) {
  PlantModel model = DefaultPlantModel();
  ASSERT_FALSE(model.terms.empty());
  for (const Term& term : model.terms) {
    EXPECT_FALSE(term.parameters.empty()) << term.name;
    for (const TermParameter& parameter : term.parameters)
      EXPECT_FALSE(parameter.unit.empty()) << parameter.name;
  }
}

TEST(PlantModel, LosesOneEffectWithEachTermThatIsSwitchedOff) {
  EXPECT_EQ(Without("torsion_spring").spring.k1_Nm_per_rad, kRigid_Nm_per_rad);
  EXPECT_EQ(Without("hysteresis").hysteresis.limit_Nm, 0.0);
  EXPECT_EQ(Without("kinematic_input_2").kinematic.amplitude_rad[1], 0.0);
  EXPECT_EQ(Without("position_dependent_stiffness").stiffness_ripple, 0.0);
  EXPECT_EQ(Without("creep").creep.share_per_decade, 0.0);
  EXPECT_EQ(Without("series_compliance").series.total_rad_per_Nm(), 0.0);
  EXPECT_EQ(Without("encoder_noise").output_encoder.noise_rad, 0.0);
  EXPECT_EQ(Without("torque_nonlinearity").transducer.nonlinearity, 0.0);
  EXPECT_EQ(Without("tooth_wear").wear.tooth_steady, 0.0);
  EXPECT_FALSE(Without("torsional_resonance").has_resonance);
}

TEST(PlantModel, LeavesTheOtherTermsAlone) {
  EXPECT_EQ(Without("torsion_spring").hysteresis.limit_Nm, PlantParameters{}.hysteresis.limit_Nm);
}

TEST(PlantModel, CompilesWithEveryTermOff) {
  PlantModel model = DefaultPlantModel();
  for (Term& term : model.terms) term.enabled = false;
  const PlantParameters off = CompilePlantModel(model);
  const FrictionAtTemperature friction = AtTemperature(off.friction, 20.0);
  EXPECT_EQ(SteadyFriction_Nm(friction, 100.0, 30.0), 0.0);
  EXPECT_EQ(EncoderTurnError_rad(off.output_encoder, 1.0), 0.0);
  EXPECT_EQ(TransducerReading_Nm(off.transducer, 30.0, 60.0), 30.0);
  EXPECT_EQ(KinematicErrorAt(CompileKinematicError(off.kinematic, 80.0), 3.0), 0.0);
  const VibrationSources sources = SourcesAt(off.vibration, {250.0, 40.0, 40.0}, {});
  EXPECT_EQ(StrongestRms_m_per_s2(off.vibration, sources), 0.0);
}

TEST(PlantModel, TreatsATermThatIsLeftOutAsOff) {
  PlantModel model = DefaultPlantModel();
  std::erase_if(model.terms, [](const Term& term) { return term.name == "creep"; });
  EXPECT_EQ(CompilePlantModel(model).creep.share_per_decade, 0.0);
}

TEST(PlantModel, RejectsAnUnknownTermAndNamesTheKnownOnes) {
  PlantModel model = DefaultPlantModel();
  model.terms.push_back({"backlsh", "", true, {}});
  const std::string message = MessageOf(model);
  EXPECT_EQ(message.find("unknown term \"backlsh\" (known: torsion_spring, hysteresis, kinematic_input_1, "),
            0u);
}

TEST(PlantModel, RejectsAnUnknownParameterAndNamesTheKnownOnes) {
  PlantModel model = DefaultPlantModel();
  FindTerm(model, "hysteresis").parameters.push_back({"width", 1.0, "rad"});
  EXPECT_EQ(
      MessageOf(model),
      "unknown parameter of term \"hysteresis\" \"width\" (known: friction_torque_Nm, yield_twist_rad)");
}

TEST(PlantModel, RejectsWhatIsGivenTwice) {
  PlantModel model = DefaultPlantModel();
  model.terms.push_back(FindTerm(model, "creep"));
  EXPECT_EQ(MessageOf(model), "term given twice: \"creep\"");
  model = DefaultPlantModel();
  FindTerm(model, "hysteresis").parameters.push_back({"yield_twist_rad", 1e-4, "rad"});
  EXPECT_EQ(MessageOf(model), "parameter of term \"hysteresis\" given twice: \"yield_twist_rad\"");
}

TEST(PlantModel, RejectsNumbersThatCannotBe) {
  PlantModel model = DefaultPlantModel();
  FindParameter(model, "creep", "share_per_decade") = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(MessageOf(model), "creep.share_per_decade = nan must be finite");
  model = DefaultPlantModel();
  FindParameter(model, "torsion_spring", "k1_Nm_per_rad") = 0.0;
  EXPECT_EQ(MessageOf(model), "torsion_spring.k1_Nm_per_rad = 0 must be above zero");
  model = DefaultPlantModel();
  FindParameter(model, "torsion_spring", "t1_Nm") = 30.0;
  EXPECT_EQ(MessageOf(model), "torsion_spring.t1_Nm = 30 must be below t2_Nm = 25");
  model = DefaultPlantModel();
  model.ratio = -80.0;
  EXPECT_EQ(MessageOf(model),
            "ratio = -80 must be above 1 (both encoders are counted so that it is positive)");
}

}  // namespace
}  // namespace strainwave::analysis::model::model_plant_model_test

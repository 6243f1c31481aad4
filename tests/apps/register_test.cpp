// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <sstream>

#include "commands.h"
#include "temporary_folder.h"

namespace keepout::app {
namespace {

class Register : public testing::Test {
 protected:
  std::string text(RegisterOptions options) {
    options.fiducials = file;
    std::ostringstream out;
    testing::internal::CaptureStderr();
    try {
      status = register_fiducials(options, out);
    } catch (const Error&) {
      doubt = testing::internal::GetCapturedStderr();  // else the next capture aborts
      throw;
    }
    doubt = testing::internal::GetCapturedStderr();
    return out.str();
  }

  int status = -1;
  std::string doubt;  // the output of the last registration on stderr
  TemporaryFolder folder;
  // A quarter turn about z, and a shift by (10, 20, 30). The last pair is off by 0.4 mm along x.
  std::filesystem::path file = folder.write("pairs.csv",
                                            "mx,my,mz,x,y,z\n0,0,0,10,20,30\n0,0,90,10,20,120\n"
                                            "80,0,0,10,100,30\n0,-70,0,80.4,20,30\n");
};

TEST_F(Register, TellsMatrixWorstPairErrorAndMarginAndWritesThem) {
  const std::filesystem::path path = folder.path() / "out.json";
  const std::string printed =
      text({.targets = {20, 0, 40, -10, 30, 50}, .fle = 0.5, .confidence = 0.95, .json = path});
  for (const char* words : {"4 pairs", "FRE 0.1", "FLE 0.5000 mm, as given", "20, 0, 40",
                            "-10, 30, 50", "at all of them and between", "probability of 0.95"}) {
    EXPECT_CONTAINS(printed, words) << words;
  }
  const nlohmann::json json = nlohmann::json::parse(std::ifstream(path));
  EXPECT_NEAR(json["mesh_from_robot"][1][0], 1.0, 1e-4);
  EXPECT_NEAR(json["mesh_from_robot"][2][3], 30.0, 0.2);
  double largest = 0.0;
  for (const nlohmann::json& pair : json["pairs"]) {
    largest = std::max(largest, pair["residual"].get<double>());
  }
  for (const nlohmann::json& pair : json["pairs"]) {
    EXPECT_EQ(pair["is_worst"], pair["residual"] == largest) << pair;
  }
  EXPECT_EQ(json["pairs"][3]["line"], 5);
  EXPECT_FALSE(json["fle_is_estimated"].get<bool>());
  ASSERT_EQ(json["targets"].size(), 2u);
  EXPECT_GT(json["margin"], json["targets"][0]["margin"]);
  EXPECT_GT(json["targets"][0]["margin"], json["targets"][0]["tre"]);
}

TEST_F(Register, DoubtsAWrongUnitOnStderrAndFailsUnlessItIsTrustedAnyway) {
  const std::string printed = text({.unit = LengthUnit::metre});
  EXPECT_TRUE(doubt.starts_with(
      "keepout: do not trust this registration: the model's points are spread 0.001 times"))
      << doubt;
  EXPECT_CONTAINS(doubt, "If the measured ones are in mm, leave out --measured-in m");
  EXPECT_EQ(status, EXIT_FAILURE);
  EXPECT_CONTAINS(printed, "No margin: the registration is in doubt");
  EXPECT_CONTAINS(text({.unit = LengthUnit::metre, .trusted_anyway = true}), "--target X Y Z");
  EXPECT_CONTAINS(doubt, "do not trust this registration");
  EXPECT_EQ(status, EXIT_SUCCESS);
  text({});
  EXPECT_EQ(doubt, "");
  EXPECT_EQ(status, EXIT_SUCCESS);
}

TEST_F(Register, DoubtsPointsThatAreInMetersOnBothSides) {
  file = folder.write(
      "meters.csv",
      "0,0,0,.01,.02,.03\n0,.08,0,.01,.1,.03\n.06,0,0,.07,.02,.03\n0,0,.07,.01,.02,.1\n");
  text({});
  EXPECT_CONTAINS(doubt, "give both sides in mm");
  EXPECT_EQ(status, EXIT_FAILURE);
}

TEST_F(Register, AFirstLineOfQuotedNumbersIsNotAHeader) {
  file = folder.write("quoted.csv", "\"0\",\"0\",\"0\",\"10\",\"20\",\"30\"\n0,0,90,10,20,120\n");
  EXPECT_CONTAINS(error_of([&] { text({}); }), "is not a number");
}

TEST_F(Register, NamesTheFileOfPointsThatFixNoRotation) {
  file = folder.write("line.csv", "0,0,0,10,20,30\n0,0,90,10,20,120\n0,0,50,10,20,80\n");
  EXPECT_CONTAINS(error_of([&] { text({}); }), "line.csv: the measured points lie on a line");
}

}  // namespace
}  // namespace keepout::app

// SPDX-License-Identifier: Apache-2.0
#include "client/load/script.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace limn::load {
namespace {

std::string complaint(const std::string& toml) {
  const auto script = parseScript(toml, ".");
  return script ? "" : script.error().message;
}

TEST(LoadScript, ReadsWhatItSays) {
  const auto script = parseScript(
      R"(decode = 0.5
[[phase]]
clients = 50
ramp_s = 5
hold_s = 30
model = "dragon"
speed_deg_s = 15
rate_hz = 10
behaviour = "churn"
[[phase]]
model = "bunny"
with_previous = true
[thresholds]
failed = 0
pose_to_packet_p99_ms = 50
)",
      ".");
  ASSERT_TRUE(script) << script.error().message;
  ASSERT_EQ(script->phases.size(), 2u);
  EXPECT_EQ(script->phases[0].clients, 50u);
  EXPECT_EQ(script->phases[0].rampSeconds, 5.0);
  EXPECT_EQ(script->phases[0].holdSeconds, 30.0);
  EXPECT_EQ(script->phases[0].model, "dragon");
  EXPECT_EQ(script->phases[0].behaviour, Behaviour::kChurn);
  EXPECT_FALSE(script->phases[0].withPrevious);
  EXPECT_TRUE(script->phases[1].withPrevious);
  EXPECT_EQ(script->decode, 0.5);
  EXPECT_EQ(script->thresholds.at("failed"), 0.0);
  EXPECT_EQ(script->thresholds.at("pose_to_packet_p99_ms"), 50.0);
}

TEST(LoadScript, ReadsEveryKeyOfAPhase) {
  const auto script = parseScript(
      R"([[phase]]
model = "dragon"
also = ["bunny", "horse"]
delay_s = 1.5
elevation_deg = -30
distance = 2.5
fov = 60
link_kbps = 500
error_px = 2
width = 640
height = 480
behaviour = "idle"
measured = false
returns = true
[[phase]]
model = "dragon"
behaviour = "slow-reader"
)",
      ".");
  ASSERT_TRUE(script) << script.error().message;
  const Phase& phase = script->phases[0];
  EXPECT_EQ(phase.also, (std::vector<std::string>{"bunny", "horse"}));
  EXPECT_EQ(phase.delaySeconds, 1.5);
  EXPECT_EQ(phase.elevationDegrees, -30.0);
  EXPECT_EQ(phase.distanceRadii, 2.5);
  EXPECT_EQ(phase.fovDegrees, 60.0);
  EXPECT_EQ(phase.linkKbps, 500.0);
  EXPECT_EQ(phase.errorPx, 2.0);
  EXPECT_EQ(phase.width, 640);
  EXPECT_EQ(phase.height, 480);
  EXPECT_EQ(phase.behaviour, Behaviour::kIdle);
  EXPECT_FALSE(phase.measured);
  EXPECT_TRUE(phase.returns);
  EXPECT_TRUE(script->phases[1].measured);
  EXPECT_FALSE(script->phases[1].returns);
  EXPECT_EQ(script->phases[1].linkKbps, 32.0) << "a slow reader without a speed";
}

TEST(LoadScript, RefusesWithTheLineAndWhatToWrite) {
  struct Case {
    const char* toml;
    const char* said;
  };

  for (const Case& bad : {
           Case{"[[phase]]\nmodel = \"a\"\nclient = 3\n", "line 3: there is no key 'client'"},
           Case{"[[phase]]\nmodel = \"a\"\nrate_hz = 0\n", "line 3: rate_hz"},
           Case{"[[phase]]\nmodel = \"a\"\nclients = 1.5\n", "whole number"},
           Case{"[[phase]]\nclients = 1\n", "names no model"},
           Case{"[[phase]]\nmodel = \"a\"\nbehaviour = \"rude\"\n", "slow-reader"},
           Case{"[[phase]]\nmodel = \"a\"\n[thresholds]\nspeed = 1\n", "pose_to_packet_p99_ms"},
           Case{"[[phase]]\nmodel = \"a\"\nalso = \"b\"\n", "line 3: also must be a list"},
           Case{"[[phase]]\nmodel = \"a\"\nalso = [1]\n", "line 3: also must be a list"},
           Case{"[[phase]]\nmodel = \"a\"\nreturns = 1\n", "line 3: returns must be true"},
           Case{"[[phase]]\nmodel = \"a\"\nmeasured = \"no\"\n", "measured must be true or false"},
           Case{"[[phase]]\nmodel = \"a\"\ndelay_s = -1\n", "line 3: delay_s"},
           Case{"decode = 1\n", "[[phase]]"},
           Case{"decode = 2\n[[phase]]\nmodel = \"a\"\n", "0 to 1"},
           Case{"[[phase]\n", "line 1"},
       }) {
    EXPECT_NE(complaint(bad.toml).find(bad.said), std::string::npos)
        << bad.toml << complaint(bad.toml);
  }
}

TEST(LoadScript, EveryTruncationIsReadOrRefused) {
  const std::string whole =
      "decode = 0.5\n[[phase]]\nmodel = \"a\"\nclients = 3\n[thresholds]\nfailed = 0\n";
  for (std::size_t length = 0; length <= whole.size(); ++length) {
    const auto script = parseScript(std::string_view(whole).substr(0, length), ".");
    EXPECT_TRUE(script || !script.error().message.empty());
  }
}

class CameraPath : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (std::filesystem::temp_directory_path() / "limn-XXXXXX").string();
    ASSERT_NE(mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
  }

  void TearDown() override { std::filesystem::remove_all(folder_); }

  Result<Script> withPath(const std::string& json) {
    std::ofstream(folder_ / "path.json") << json;
    return parseScript("[[phase]]\nmodel = \"a\"\npath = \"path.json\"\n", folder_);
  }

  std::filesystem::path folder_;
};

TEST_F(CameraPath, IsReadFromBesideTheScript) {
  const auto script = withPath(
      R"([{"t":0,"eye":[0,0,3],"target":[0,0,0]},{"t":0.5,"eye":[3,0,0],"target":[0,0,0],"fov":60}])");
  ASSERT_TRUE(script) << script.error().message;
  ASSERT_EQ(script->phases[0].recorded.size(), 2u);
  EXPECT_EQ(script->phases[0].recorded[1].camera.fovDegrees, 60.0);
  EXPECT_EQ(script->phases[0].recorded[1].seconds, 0.5);
}

TEST_F(CameraPath, IsRefusedWhenItMakesNoSense) {
  for (const char* json :
       {"",
        "[]",
        "3",
        "[3]",
        R"([{"eye":[0,0],"target":[0,0,0]}])",
        R"([{"eye":[0,3,0],"target":[0,0,0]}])",
        R"([{"eye":[0,0,3],"target":[0,0,0],"fov":"wide"}])",
        R"([{"t":1,"eye":[0,0,3],"target":[0,0,0]},{"t":1,"eye":[0,0,3],"target":[0,0,0]}])"}) {
    EXPECT_FALSE(withPath(json)) << json;
  }
}

}  // namespace
}  // namespace limn::load

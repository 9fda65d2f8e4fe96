// SPDX-License-Identifier: Apache-2.0
#include "server/apps/model_folder.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

namespace limn {
namespace {

namespace fs = std::filesystem;

class ModelFolder : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (fs::temp_directory_path() / "limn-models-XXXXXX").string();
    folder_ = ::mkdtemp(pattern.data());
  }

  void TearDown() override {
    std::error_code error;
    fs::remove_all(folder_, error);
  }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
  }

  fs::path folder_;
};

TEST_F(ModelFolder, NamesMeshFilesByTheirStems) {
  write("a.ply", "x");
  write("B.OBJ", "x");
  write("notes.txt", "x");
  const auto scan = scanModelFolder(folder_);
  ASSERT_TRUE(scan);
  ASSERT_EQ(scan->models.size(), 2U);
  EXPECT_EQ(scan->models.at("a").path, folder_ / "a.ply");
  EXPECT_TRUE(scan->models.contains("B"));
}

TEST_F(ModelFolder, TwoFilesOfOneStemBothGetAName) {
  write("a.obj", "x");
  write("a.ply", "x");
  const auto scan = scanModelFolder(folder_);
  EXPECT_EQ(scan->models.at("a").path, folder_ / "a.obj");
  EXPECT_EQ(scan->models.at("a.ply").path, folder_ / "a.ply");
}

TEST_F(ModelFolder, CountsFilesThatCannotBeNamed) {
  write("a\nb.ply", "x");
  const auto scan = scanModelFolder(folder_);
  EXPECT_TRUE(scan->models.empty());
  EXPECT_EQ(scan->refusedFiles, 1U);
}

TEST_F(ModelFolder, SeesThatAFileOrItsOptionsChanged) {
  write("a.ply", "x");
  const auto before = scanModelFolder(folder_)->models.at("a");
  EXPECT_EQ(scanModelFolder(folder_)->models.at("a"), before);
  write("a.ply", "xy");
  const auto longer = scanModelFolder(folder_)->models.at("a");
  EXPECT_NE(longer, before);
  write("limn.toml", "quantization = 12\n");
  EXPECT_NE(scanModelFolder(folder_)->models.at("a"), longer);
}

TEST_F(ModelFolder, SaysWhatIsWrongWithTheFolder) {
  EXPECT_EQ(scanModelFolder(folder_ / "none").error().code, ErrorCode::kIo);
  write("limn.toml", "quantisation = 12\n");
  EXPECT_EQ(scanModelFolder(folder_).error().code, ErrorCode::kInvalidArgument);
}

TEST(PrepareSettings, AModelsOwnOptionsComeFirst) {
  const auto settings = PrepareSettings::parse(
      "quantization = 12\ncost = \"volume\"\n[models.dragon]\nquantization = 16\n");
  ASSERT_TRUE(settings) << settings.error().message;
  EXPECT_EQ(
      settings->flagsFor("other"),
      (PrepareFlags{"--cost", "volume", "--quantization", "12"}));
  EXPECT_EQ(
      settings->flagsFor("dragon"),
      (PrepareFlags{"--cost", "volume", "--quantization", "16"}));
}

TEST(PrepareSettings, RefusesWhatItDoesNotKnow) {
  for (const char* text :
       {"quantization =",
        "store = \"x\"",
        "quantization = [1]",
        "models = 1",
        "[models]\na = 1",
        "[models.a]\nstore = \"x\""}) {
    const auto settings = PrepareSettings::parse(text);
    ASSERT_FALSE(settings) << text;
    EXPECT_NE(settings.error().message.find("limn.toml"), std::string::npos);
  }
}

}  // namespace
}  // namespace limn

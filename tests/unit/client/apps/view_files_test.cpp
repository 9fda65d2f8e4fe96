// SPDX-License-Identifier: Apache-2.0
#include "client/apps/view_files.h"

#include "client/apps/temporary_directory.h"
#include "client/pose/recorded_path.h"

#include <gtest/gtest.h>

#include <fstream>
#include <memory>

namespace limn {
namespace {

class ViewFilesTest : public testing::Test {
 protected:
  void SetUp() override {
    auto made = TemporaryDirectory::create();
    ASSERT_TRUE(made) << made.error().message;
    folder_ = *std::move(made);
  }

  std::unique_ptr<TemporaryDirectory> folder_;
};

TEST_F(ViewFilesTest, NamesNothingThatIsThereOrWasNamedBefore) {
  std::ofstream(folder_->path() / "cow-001.png") << "somebody's";
  ViewFiles files(folder_->path());
  EXPECT_EQ(files.name("cow", ".png").filename(), "cow-002.png");
  EXPECT_EQ(files.name("cow", ".png").filename(), "cow-003.png");
  EXPECT_EQ(files.name("cow", ".svg").filename(), "cow-001.svg");
  EXPECT_EQ(files.named().size(), 3U);
}

TEST_F(ViewFilesTest, ARecordedPathCanBeReadAgain) {
  ViewFiles files(folder_->path());
  EXPECT_EQ(files.endRecording("cow"), std::nullopt);
  files.beginRecording();
  EXPECT_TRUE(files.isRecording());
  Camera camera;
  files.record(1.0, camera);
  camera.eye.x += 1.0;
  files.record(2.0, camera);
  const auto file = files.endRecording("cow");
  EXPECT_FALSE(files.isRecording());
  ASSERT_TRUE(file && *file);
  const auto path = readRecordedPath(**file);
  ASSERT_TRUE(path) << path.error().message;
  EXPECT_EQ(durationOf(*path), 1.0);
}

TEST_F(ViewFilesTest, TheCommandQuotesWhatAShellWouldTakeApart) {
  SourceOptions source;
  source.meshFile = "it's a mesh.ply";
  const std::string command = renderCommand(source, "mesh", ViewChoices{}, "camera.json");
  EXPECT_TRUE(command.starts_with("limn-client render --mesh 'it'\\''s a mesh.ply'")) << command;
  EXPECT_TRUE(command.ends_with("--camera-file 'camera.json' --out picture.png")) << command;
}

}  // namespace
}  // namespace limn

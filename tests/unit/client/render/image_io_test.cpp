// SPDX-License-Identifier: Apache-2.0
#include "client/render/image_io.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace limn {
namespace {

std::filesystem::path scratch(const std::string& name) {
  const auto folder = std::filesystem::path(testing::TempDir()) / "limn-image-io";
  std::filesystem::create_directories(folder);
  return folder / name;
}

Image gradient(int width, int height) {
  Image image{width, height, {}};
  for (int i = 0; i < 4 * width * height; ++i)
    image.rgba.push_back(static_cast<std::uint8_t>(i * 7));
  return image;
}

TEST(ImageIo, APictureComesBackAsItWas) {
  const Image image = gradient(13, 7);
  const auto path = scratch("round.png");
  ASSERT_TRUE(writePng(path, image));
  const auto read = readPng(path);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->width, 13);
  EXPECT_EQ(read->height, 7);
  EXPECT_EQ(read->rgba, image.rgba);
  EXPECT_FALSE(std::filesystem::exists(path.string() + ".part"));
}

TEST(ImageIo, NoTruncationIsTakenForAPicture) {
  const auto path = scratch("whole.png");
  ASSERT_TRUE(writePng(path, gradient(9, 9)));
  std::ifstream file(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  // The last chunk (12 bytes, IEND) holds no pixels.
  for (std::size_t size = 0; size + 12 < bytes.size(); ++size) {
    const auto cut = scratch("cut.png");
    std::ofstream(cut, std::ios::binary) << bytes.substr(0, size);
    const auto read = readPng(cut);
    if (read) {
      EXPECT_EQ(read->rgba.size(), 4U * 9U * 9U);
    }
    if (size < 40) {
      EXPECT_FALSE(read) << size;
    }
  }
}

TEST(ImageIo, FailuresSayWhichFile) {
  const auto missing = readPng(scratch("no-such.png"));
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, ErrorCode::kNotFound);
  const auto nowhere = writePng(scratch("no-folder") / "a.png", gradient(2, 2));
  ASSERT_FALSE(nowhere);
  EXPECT_EQ(nowhere.error().code, ErrorCode::kIo);
  EXPECT_NE(nowhere.error().message.find("no-folder"), std::string::npos);
  EXPECT_EQ(writePng(scratch("empty.png"), {}).error().code, ErrorCode::kInvalidArgument);
}

TEST(ImageIo, ADeviceIsWrittenToAndNotReplaced) {
  ASSERT_TRUE(writePng("/dev/null", gradient(2, 2)));
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
}

}  // namespace
}  // namespace limn

// SPDX-License-Identifier: Apache-2.0
#include "client/stroke/style.h"

#include <gtest/gtest.h>

#include <string>

namespace limn {
namespace {

constexpr char kGood[] = R"(
[stroke]
width_px = 3
taper_px = 5.5
[visible]
texture = "visible.png"
length_px = 100
color = "#102030"
[hidden]
texture = "hidden.png"
opacity = 0.5
[paper]
color = "#ffffff"
grain = 0.25
)";

TEST(Style, ReadsWhatIsGivenAndKeepsDefaults) {
  const auto style = parseStyle(kGood);
  ASSERT_TRUE(style) << style.error().message;
  EXPECT_FLOAT_EQ(style->widthPx, 3.0F);
  EXPECT_FLOAT_EQ(style->taperPx, 5.5F);
  EXPECT_FLOAT_EQ(style->body, StrokeStyle{}.body);
  EXPECT_EQ(style->visible.file, "visible.png");
  EXPECT_FLOAT_EQ(style->visible.color.z, 48.0F / 255.0F);
  EXPECT_FLOAT_EQ(style->hidden.opacity, 0.5F);
  EXPECT_FLOAT_EQ(style->grain, 0.25F);
}

TEST(Style, RefusesMistakesAndNamesThem) {
  const auto refused = [](const std::string& text, const std::string& word) {
    const auto style = parseStyle(text);
    ASSERT_FALSE(style) << text;
    EXPECT_EQ(style.error().code, ErrorCode::kCorrupt);
    EXPECT_NE(style.error().message.find(word), std::string::npos) << style.error().message;
  };
  const std::string good = kGood;
  refused(good + "[brush]\nx = 1\n", "brush");
  refused(good + "tint = 1\n", "paper.tint");
  refused("width = 3\n" + good, "width");
  refused("[stroke]\nwidth_px = -1\n", "stroke.width_px");
  refused("[stroke]\nwidth_px = nan\n", "stroke.width_px");
  refused("[stroke]\nwidth_px = \"3\"\n", "stroke.width_px");
  refused("[paper]\ncolor = \"white\"\n", "paper.color");
  refused("[stroke]\nwidth_px = 3\n", "visible.texture");
  refused("[stroke\n", "line 1");
  refused("stroke = 3\n", "stroke");
}

TEST(Style, TexturesCannotLieOutsideTheStylesFolder) {
  for (const char* file : {"../other.png", "/etc/passwd", ".hidden", ""}) {
    EXPECT_FALSE(parseStyle("[visible]\ntexture = \"" + std::string(file) + "\"\n")) << file;
  }
}

TEST(Style, ColoursAreSixHexDigits) {
  const auto color = parseColor("#ff8000");
  ASSERT_TRUE(color);
  EXPECT_EQ(*color, glm::vec3(1.0F, 128.0F / 255.0F, 0.0F));
  for (const char* text : {"", "#", "#ff80", "ff8000", "#ff80000", "#gg8000", "#-12345"}) {
    EXPECT_FALSE(parseColor(text)) << text;
  }
}

}  // namespace
}  // namespace limn

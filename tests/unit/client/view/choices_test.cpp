// SPDX-License-Identifier: Apache-2.0
#include "client/view/choices.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace limn {
namespace {

ViewMemory unusual() {
  ViewMemory memory;
  memory.choices = {
      "shaded",
      "brute",
      "edges",
      "border",
      "ink",
      "hand",
      "off",
      750,
      3.5,
      2.0,
      true,
      55.0,
      true,
      10.0,
      -20.0,
      false,
      true};
  memory.width = 900;
  memory.height = 700;
  return memory;
}

TEST(ViewMemory, ComesBackAsItWas) {
  const ViewMemory memory = unusual();
  const ViewMemory back = viewMemoryFromJson(toJson(memory));
  EXPECT_EQ(back.choices, memory.choices);
  EXPECT_EQ(back.width, memory.width);
  EXPECT_EQ(back.height, memory.height);
}

TEST(ViewMemory, DamageLeavesTheBeginningsValues) {
  for (const char* damaged : {"", "{", "[]", "7", R"({"fov":"wide","menu":1,"style":3})"}) {
    const ViewMemory back = viewMemoryFromJson(damaged);
    EXPECT_EQ(back.choices, ViewChoices{}) << damaged;
  }
  EXPECT_EQ(viewMemoryFromJson(R"({"style":"ink","fov":"wide"})").choices.style, "ink");
}

TEST(ViewMemory, SizesOutOfReasonAreBroughtIn) {
  const ViewMemory back =
      viewMemoryFromJson(R"({"window_width":-5,"window_height":999999,"fov":0})");
  EXPECT_GE(back.width, 320);
  EXPECT_LE(back.height, 8192);
  EXPECT_GE(back.choices.fovDegrees, 5.0);
}

TEST(ViewChoices, AreTheFlagsThatDrawThem) {
  const std::vector<std::string> flags = flagsOf(unusual().choices);
  const auto valueOf = [&](const char* flag) -> std::string {
    const auto at = std::ranges::find(flags, flag);
    return at == flags.end() || at + 1 == flags.end() ? "" : *(at + 1);
  };
  EXPECT_EQ(valueOf("--draw"), "shaded");
  EXPECT_EQ(valueOf("--features"), "border");
  EXPECT_EQ(valueOf("--width"), "3.5");
  EXPECT_EQ(valueOf("--hull-faces"), "750");
  EXPECT_EQ(flags.back(), "--ortho");
}

TEST(ViewChoices, WordsOfAListAreTurnedOnAndOff) {
  EXPECT_TRUE(hasWord("crease,border", "border"));
  EXPECT_FALSE(hasWord("crease,border", "bord"));
  EXPECT_EQ(toggled("crease,border", "crease"), "border");
  EXPECT_EQ(toggled("border", "border"), "none");
  EXPECT_EQ(toggled("none", "seam"), "seam");
  EXPECT_EQ(toggled("crease", "seam"), "crease,seam");
}

}  // namespace
}  // namespace limn

// SPDX-License-Identifier: Apache-2.0
#include "server/store/manifest.h"

#include <gtest/gtest.h>

namespace limn {
namespace {

std::span<const std::uint8_t> bytesOf(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

Manifest example() {
  Manifest manifest;
  manifest.id.fill(0xAB);
  manifest.sections.push_back({"info", "info.bin", 12, Sha256Digest{1}});
  manifest.sections.push_back({"blocks", "blocks.bin", 0, Sha256Digest{2}});
  manifest.report = R"({"name":"dragon","levels":[1,2]})";
  return manifest;
}

TEST(Manifest, ReadsBackWhatItWrote) {
  const auto text = serializeManifest(example());
  ASSERT_TRUE(text);
  const auto back = parseManifest(bytesOf(*text));
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(back->id, example().id);
  ASSERT_EQ(back->sections.size(), 2U);
  EXPECT_EQ(back->sections[0].file, "info.bin");
  EXPECT_EQ(back->sections[1].sha256, Sha256Digest{2});
  EXPECT_EQ(back->report, R"({"levels":[1,2],"name":"dragon"})");
}

TEST(Manifest, RefusesAReportThatIsNoObject) {
  for (const char* report : {"", "[]", "{", "1", "{} {}"}) {
    Manifest manifest = example();
    manifest.report = report;
    EXPECT_FALSE(serializeManifest(manifest)) << report;
  }
}

TEST(Manifest, RefusesEveryTruncation) {
  const auto text = serializeManifest(example());
  ASSERT_TRUE(text);
  for (std::size_t length = 0; length + 1 < text->size(); ++length) {
    EXPECT_FALSE(parseManifest(bytesOf(*text).first(length))) << length;
  }
}

TEST(Manifest, RefusesAFileOutsideTheAsset) {
  for (const char* file : {"../info.bin", "/etc/passwd", "", "other.bin"}) {
    Manifest manifest = example();
    manifest.sections[0].file = file;
    const auto text = serializeManifest(manifest);
    ASSERT_TRUE(text);
    EXPECT_FALSE(parseManifest(bytesOf(*text))) << file;
  }
}

TEST(Manifest, NamesTheVersionThatItCannotRead) {
  std::string text = *serializeManifest(example());
  text.replace(text.find("\"format\": 1"), 11, "\"format\": 7");
  const auto back = parseManifest(bytesOf(text));
  ASSERT_FALSE(back);
  EXPECT_EQ(back.error().code, ErrorCode::kUnsupported);
}

TEST(NameRecord, NoticesEveryFlippedBit) {
  const std::string text = serializeNameRecord({"drag\"on", Sha256Digest{7}, "/models/dragon.ply"});
  const auto back = parseNameRecord(bytesOf(text));
  ASSERT_TRUE(back);
  EXPECT_EQ(back->name, "drag\"on");
  EXPECT_EQ(back->source, "/models/dragon.ply");
  for (std::size_t bit = 0; bit < 8 * text.size(); ++bit) {
    std::string flipped = text;
    flipped[bit / 8] = static_cast<char>(flipped[bit / 8] ^ (1 << (bit % 8)));
    EXPECT_FALSE(parseNameRecord(bytesOf(flipped))) << bit;
  }
}

TEST(NameFile, IsDifferentForEveryNameAndNeverLeadsOut) {
  EXPECT_EQ(nameFile("dragon-100k.v2_a"), "dragon-100k.v2_a.json");
  EXPECT_EQ(nameFile("../x"), "%2E.%2Fx.json");
  EXPECT_EQ(nameFile(".hidden"), "%2Ehidden.json");
  EXPECT_EQ(nameFile("a b%\xC3\xA9"), "a%20b%25%C3%A9.json");
  const std::string longA = nameFile(std::string(200, '/'));
  const std::string longB = nameFile(std::string(199, '/') + "?");
  EXPECT_LT(longA.size(), 255U);
  EXPECT_NE(longA, longB);
}

TEST(ModelName, IsUtf8WithoutControlCharacters) {
  EXPECT_TRUE(isModelName("a b \"quoted\" \xC3\xA9/\\"));
  EXPECT_FALSE(isModelName(""));
  EXPECT_FALSE(isModelName("a\nb"));
  EXPECT_FALSE(isModelName("\xFF"));
  EXPECT_FALSE(isModelName("cut\xC3"));
  EXPECT_FALSE(isModelName(std::string(201, 'a')));
}

}  // namespace
}  // namespace limn

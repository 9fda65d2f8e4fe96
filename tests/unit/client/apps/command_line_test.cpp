// SPDX-License-Identifier: Apache-2.0
#include "client/apps/command_line.h"

#include "client/apps/render_views.h"

#include <gtest/gtest.h>

#include <string>
#include <variant>
#include <vector>

namespace limn {
namespace {

std::vector<std::string> words(const std::string& line) {
  std::vector<std::string> result;
  std::string word;
  for (const char c : line + " ") {
    if (c != ' ') {
      word += c;
    } else if (!word.empty()) {
      result.push_back(word);
      word.clear();
    }
  }
  return result;
}

Result<Command> parse(const std::string& line) {
  return parseCommandLine(words(line));
}

RenderCommandOptions render(const Result<Command>& line) {
  return std::get<RenderCommandOptions>(*line);
}

ViewCommandOptions view(const Result<Command>& line) {
  return std::get<ViewCommandOptions>(*line);
}

TEST(RenderOptions, UnderstandsEveryFlag) {
  const auto line = parse(
      "render --server ws://h:1 --model dragon --token-file t --camera orbit:10,20,4 --fov 50 "
      "--ortho "
      "--size 640x480 --until bytes:5000 --error-px 2 --draw shaded --detector precomputed "
      "--silhouette edges --features crease,seam --style ink --width 2.5 --hidden off --gl osmesa "
      "--frames 3 --out a.png --report r.json --dump-mesh m.ply --dump-lines l.json --check "
      "--reference ref --brush lazy --brush-amplitude 7 --brush-frequency 2 --brush-seed 9 "
      "--width-falloff 0.5");
  ASSERT_TRUE(line) << line.error().message;
  ASSERT_TRUE(std::holds_alternative<RenderCommandOptions>(*line));
  const RenderCommandOptions& o = render(line);
  EXPECT_EQ(o.source.serverUrl, "ws://h:1");
  EXPECT_EQ(o.source.model, "dragon");
  EXPECT_EQ(o.orbit->distanceRadii, 4.0);
  EXPECT_EQ(*o.fovDegrees, 50.0);
  EXPECT_TRUE(o.orthographic);
  EXPECT_EQ(o.viewport.width, 640);
  EXPECT_EQ(o.viewport.height, 480);
  EXPECT_EQ(o.until->kind, StopCondition::Kind::kBytes);
  EXPECT_EQ(o.until->bytes, 5000U);
  EXPECT_EQ(o.errorPx, 2.0);
  EXPECT_EQ(o.draw, DrawMode::kShaded);
  EXPECT_EQ(o.detector, DetectorMethod::kPrecomputed);
  EXPECT_EQ(o.detectorName, "precomputed");
  EXPECT_EQ(o.silhouette, SilhouetteKind::kEdges);
  EXPECT_TRUE(o.features.crease && o.features.seam && !o.features.border);
  EXPECT_FALSE(o.features.surface.any());
  EXPECT_EQ(o.style, "ink");
  EXPECT_EQ(*o.widthPx, 2.5);
  EXPECT_EQ(o.widthFalloff, 0.5);
  EXPECT_EQ(o.brush.kind, BrushKind::kLazy);
  EXPECT_EQ(o.brush.amplitudePx, 7.0F);
  EXPECT_EQ(o.brush.wavelengthPx, 50.0F);
  EXPECT_EQ(o.brush.seed, 9U);
  EXPECT_EQ(o.hidden, HiddenLines::kOff);
  EXPECT_EQ(o.gl, GlBackend::kOsmesa);
  EXPECT_EQ(o.frames, 3U);
  EXPECT_TRUE(o.check);
}

TEST(RenderOptions, TheDetectorIsExactUnlessSaid) {
  const auto line = parse("render --asset a --out x.png");
  ASSERT_TRUE(line);
  EXPECT_EQ(render(line).detector, DetectorMethod::kExact);
  EXPECT_EQ(render(line).detectorName, "exact");
}

TEST(RenderOptions, EveryDetectorHasItsName) {
  for (const auto& [name, method] :
       {std::pair{"random", DetectorMethod::kRandom},
        std::pair{"coherence-a", DetectorMethod::kCoherenceA},
        std::pair{"coherence-b", DetectorMethod::kCoherenceB},
        std::pair{"image", DetectorMethod::kImage}}) {
    const auto line = parse(std::string("render --asset a --out x.png --detector ") + name);
    ASSERT_TRUE(line) << name;
    EXPECT_EQ(render(line).detector, method);
    EXPECT_EQ(render(line).detectorName, name);
  }
}

TEST(RenderOptions, NoFramesStreamWithoutDrawing) {
  const auto line = parse("render --asset a --report r.json --dump-mesh m.ply --frames 0");
  ASSERT_TRUE(line);
  EXPECT_EQ(render(line).frames, 0U);
  const auto cameras = camerasOf(render(line), {});
  ASSERT_TRUE(cameras);
  EXPECT_EQ(cameras->size(), 1U);
}

TEST(RenderOptions, ALightIsThreeNumbers) {
  const auto line = parse("render --asset a --out x.png --light 1,-2.5,3e2");
  ASSERT_TRUE(line);
  EXPECT_EQ(render(line).light, glm::dvec3(1.0, -2.5, 300.0));
  EXPECT_EQ(render(parse("render --asset a --out x.png")).light, std::nullopt);
  for (const char* light :
       {"1", "1,2", "1,2,3,4", "1,2,3,", "1,,3", "x,y,z", "1,2,nan", "1,2,inf"}) {
    const auto parsed = parse(std::string("render --asset a --out x.png --light ") + light);
    ASSERT_FALSE(parsed) << light;
    EXPECT_EQ(parsed.error().code, ErrorCode::kInvalidArgument) << light;
  }
}

TEST(RenderOptions, DetectorsTakeTheirParameters) {
  const auto line = parse(
      "render --asset a --out x.png --random-share 0.2 --random-sharp --random-walk 7 --rings 3 "
      "--follow-motion --history 5 --reseed-every 10 --reseed-below 0.8 --reseed-with random "
      "--seed-viewpoints 2 --seed-walk 9");
  ASSERT_TRUE(line) << line.error().message;
  const DetectorOptions& o = render(line).detectorParameters;
  EXPECT_EQ(o.random.fraction, 0.2);
  EXPECT_TRUE(o.random.sortByDihedral);
  EXPECT_EQ(o.random.searchSteps, 7);
  EXPECT_EQ(o.coherence.rings, 3);
  EXPECT_TRUE(o.coherence.followMotion);
  EXPECT_EQ(o.coherence.longestHistory, 5);
  EXPECT_EQ(o.coherence.reseedEvery, 10);
  EXPECT_EQ(o.coherence.reseedBelow, 0.8);
  EXPECT_EQ(o.coherence.reseedWith, DetectorMethod::kRandom);
  EXPECT_EQ(o.seedViewpoints, 2);
  EXPECT_EQ(o.seedSearchSteps, 9);
  EXPECT_FALSE(parse("render --asset a --out x.png --random-share 2"));
  EXPECT_FALSE(parse("render --asset a --out x.png --reseed-with cones"));
}

TEST(RenderOptions, HelpHasExamplesAndVersionANumber) {
  for (const char* line : {"--help", "render --help"}) {
    const auto help = parse(line);
    ASSERT_TRUE(help) << help.error().message;
    const auto* print = std::get_if<PrintCommand>(&*help);
    ASSERT_NE(print, nullptr);
    EXPECT_NE(print->text.find("Examples:"), std::string::npos);
  }
  EXPECT_TRUE(std::get<PrintCommand>(*parse("--version")).text.starts_with("limn-client "));
}

TEST(RenderOptions, WrongUsageGetsOneLine) {
  for (const char* line :
       {"",
        "draw",
        "render",
        "render --out x.png",
        "render --asset a",
        "render --bogus",
        "render --asset a --mesh b --out x.png",
        "render --server ws://h:1 --out x.png",
        "render --server h:1 --model m --out x.png",
        "render --asset a --model m --out x.png",
        "render --asset a --token-file t --out x.png",
        "render --server ws://h:1 --model a/b --out x.png",
        "render --asset a --out x.png --camera 30,20",
        "render --asset a --out x.png --fov 0",
        "render --asset a --out x.png --fov wide",
        "render --asset a --out x.png --size 0x10",
        "render --asset a --out x.png --size 10",
        "render --asset a --out x.png --size 10x10x10",
        "render --asset a --out x.png --until soon",
        "render --asset a --out x.png --until bytes:0",
        "render --asset a --out x.png --until seconds:-1",
        "render --asset a --out x.png --until partial",
        "render --asset a --out x.png --error-px 0",
        "render --asset a --out x.png --draw magic",
        "render --asset a --out x.png --detector magic",
        "render --asset a --out x.png --silhouette thin",
        "render --asset a --out x.png --features ridges",
        "render --asset a --out x.png --features ,",
        "render --asset a --out x.png --hidden maybe",
        "render --asset a --out x.png --gl vulkan",
        "render --asset a --out x.png --width -1",
        "render --asset a --out x.png --width-units miles",
        "render --asset a --out x.png --width-units model",
        "render --asset a --out x.png --width-falloff 3",
        "render --asset a --out x.png --brush-frequency 0",
        "render --asset a --out x.png --brush broom",
        "render --asset a --out x.png --frames 0",
        "render --asset a --report r.json --dump-lines l.json --frames 0",
        "render --asset a --report r.json --check --frames 0",
        "render --asset a --report r.json --frames 100001",
        "render --asset a --out x.png --path spiral",
        "render --asset a --out x.png --path orbit --frames 3",
        "render --asset a --out x.png --reference r",
        "render --asset a --out",
        "render --asset a --out x.png --camera orbit:1,2 --camera-file c.json",
        "render --asset a --out x.png --draw clip --contours server",
        "render --server ws://h:1 --model m --out x.png --draw shaded --contours server",
        "render --server ws://h:1 --model m --out x.png --with n",
        "render --server ws://h:1 --model m --svg x.svg --draw clip --with n",
        "render --server ws://h:1 --model m --out x.png --draw clip --with n@1,2",
        "render --server ws://h:1 --model m --out x.png --draw clip --with n --until seconds:2",
        "render --server ws://h:1 --model m --out x.png --draw clip --with @1,2,3",
        "render --server ws://h:1 --model m --out x.png --draw clip --contours both",
        "render --server ws://h:1 --model m --out x.png --draw clip --contours server --until "
        "exact",
        "render --asset a --out x.png --draw clip --light 1,2,3",
        "render --mesh a --out x.png --quantization 9"}) {
    const auto parsed = parse(line);
    ASSERT_FALSE(parsed) << line;
    EXPECT_EQ(parsed.error().code, ErrorCode::kInvalidArgument) << line;
    EXPECT_EQ(parsed.error().message.find('\n'), std::string::npos) << parsed.error().message;
  }
}

TEST(RenderOptions, ClippingTakesTheOutlineOfEdges) {
  const auto parsed =
      parse("render --server ws://h:1 --model m --out x.png --draw clip --contours server");
  ASSERT_TRUE(parsed) << parsed.error().message;
  EXPECT_EQ(render(parsed).draw, DrawMode::kClip);
  EXPECT_EQ(render(parsed).silhouette, SilhouetteKind::kEdges);
  EXPECT_EQ(render(parsed).contours, SessionMachine::Options::Contours::kServer);
}

TEST(RenderOptions, SeveralModelsComeWithTheirPlaces) {
  const auto parsed =
      parse("render --asset a --out x.png --draw clip --with b --with c/d@1,-2,3e1");
  ASSERT_TRUE(parsed) << parsed.error().message;
  ASSERT_EQ(render(parsed).with.size(), 2U);
  EXPECT_EQ(render(parsed).with[0].model, "b");
  EXPECT_FALSE(render(parsed).with[0].place);
  EXPECT_EQ(render(parsed).with[1].model, "c/d");
  EXPECT_EQ(render(parsed).with[1].place, glm::dvec3(1.0, -2.0, 30.0));
}

TEST(ViewOptions, AreCheckedAsRendersAre) {
  const auto parsed = parse("view --server ws://localhost:1 --style ink --width 3 --size 640x480");
  ASSERT_TRUE(parsed.has_value()) << parsed.error().message;
  ASSERT_TRUE(std::holds_alternative<ViewCommandOptions>(*parsed));
  EXPECT_EQ(view(parsed).size->width, 640);
  ViewChoices remembered;
  remembered.detector = "brute";
  const ViewChoices choices = chosenBy(view(parsed), remembered);
  EXPECT_EQ(choices.style, "ink");
  EXPECT_EQ(choices.detector, "brute");
  const auto look = understand(choices, view(parsed));
  ASSERT_TRUE(look.has_value());
  EXPECT_EQ(look->detector, DetectorMethod::kBrute);
  EXPECT_EQ(look->widthPx, 3.0);
  for (const char* wrong :
       {"view",
        "view --asset a --mesh b",
        "view --asset a --draw paint",
        "view --asset a --size 3",
        "view --asset a --gl glide"})
    EXPECT_FALSE(parse(wrong).has_value()) << wrong;
}

TEST(RenderOptions, EveryWayToDrawIsParsed) {
  for (const char* name :
       {"strokes",
        "shaded",
        "clip",
        "image-edges",
        "geometry-shader",
        "conditional-lines",
        "image-precision:charcoal"}) {
    const auto parsed = parse(std::string("render --asset a --out x.png --draw ") + name);
    ASSERT_TRUE(parsed) << parsed.error().message;
    EXPECT_EQ(nameOf(render(parsed).draw), name);
  }
}

TEST(RenderOptions, LinesOfImagePrecisionMethodsHaveAColourAndFade) {
  const auto parsed = parse(
      "render --asset a --out x.png --draw image-precision:z-scale --line-color #ff8000 "
      "--line-fade 0.5 --first-layer numbers");
  ASSERT_TRUE(parsed) << parsed.error().message;
  EXPECT_EQ(render(parsed).draw, DrawMode::kBackZScale);
  EXPECT_EQ(render(parsed).lineColor->x, 1.0F);
  EXPECT_EQ(render(parsed).lineFade, 0.5);
  EXPECT_EQ(render(parsed).firstLayer, FirstLayer::kNumbers);
  for (const char* wrong :
       {"--line-color red", "--line-fade 2", "--first-layer ids", "--draw image-precision:glow"}) {
    EXPECT_FALSE(parse(std::string("render --asset a --out x.png ") + wrong)) << wrong;
  }
}

}  // namespace
}  // namespace limn

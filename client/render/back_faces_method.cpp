// SPDX-License-Identifier: Apache-2.0
// Based on: R. Raskar and M. Cohen, "Image Precision Silhouette Edges", I3D 1999. J. Rossignac and
// M. van Emmerik, "Hidden Contours on a Frame-Buffer", 1992.
// Deviations: see client/render/README.md, "Silhouettes from back faces".
#include "client/render/back_faces_method.h"

#include "client/render/face_uniforms.h"
#include "client/render/shaders/back_face_shaders.h"

#include <algorithm>
#include <array>
#include <string>

namespace limn {
namespace {

/// Against rounding, of the distance.
constexpr float kWirePull = 1e-5F;
/// Back faces that are moved are grown, too, by this many line widths: however thin what shows of
/// them is, pixels' centres meet it.
constexpr float kBarely = 0.5F;
/// Charcoal's greys: factor and upper bound, on the front and of strokes.
constexpr glm::vec2 kFrontTone(1.5F, 1.0F);
constexpr glm::vec2 kStrokeTone(1.0F, 1.1F / 3.0F);

struct Sources {
  const char* name;
  std::string vertex;
  std::string_view fragment;
};

Sources sourcesOf(DrawMode mode) {
  using namespace shaders;
  const std::string common = std::string(kEs300) + std::string(kFaceCommon);
  switch (mode) {
    case DrawMode::kBackWireframe:
      return {"wireframe back faces", common + std::string(kWireframeMain), kLineFragment};
    case DrawMode::kBackCharcoal:
      return {
          "charcoal",
          common + std::string(kFattenGrey) + std::string(kFattenMain),
          kGreyFragment};
    default:
      return {
          "back faces",
          common + std::string(kFattenLine) + std::string(kFattenMain),
          kLineFragment};
  }
}

/// The uniforms of kFattenMain, by way. Widths are the line's.
struct Change {
  float grow = 0.0F;
  float steepest = 2.0F;
  float pullShare = 0.0F;  // of the distance, for a line of one pixel
  float pullRadii = 0.0F;  // of the model, for a line of one pixel
  float bySlope = 0.0F;
  float mostBySlope = 0.0F;
  float grazing = 0.0F;
};

Change changeOf(DrawMode mode) {
  switch (mode) {
    case DrawMode::kBackTranslate:
      return {.grow = kBarely, .pullRadii = 0.004F};
    case DrawMode::kBackZScale:
      return {.grow = kBarely, .pullShare = 0.0014F};
    case DrawMode::kBackOffset:
      return {.grow = kBarely, .bySlope = 1.2F, .mostBySlope = 5.0F};
    case DrawMode::kBackCharcoal:
      return {.grow = 1.0F, .steepest = 12.0F, .grazing = 0.1F};
    default:
      return {.grow = 1.0F};
  }
}

}  // namespace

Result<std::unique_ptr<DrawingMethod>> BackFacesMethod::create(DrawMode mode, DrawTools& tools) {
  std::unique_ptr<BackFacesMethod> method(new BackFacesMethod(mode, tools));
  if (auto ok = method->compile(); !ok) return tl::unexpected(ok.error());
  return method;
}

Result<void> BackFacesMethod::compile() {
  using namespace shaders;
  const std::string common = std::string(kEs300) + std::string(kFaceCommon);
  const Sources sources = sourcesOf(mode_);
  auto program = gl::Program::build(tools_.api(), sources.name, sources.vertex, sources.fragment);
  if (!program) return tl::unexpected(program.error());
  auto number = gl::Program::build(
      tools_.api(),
      "face numbers",
      common + std::string(kFaceNumberMain),
      kFaceNumberFragment);
  if (!number) return tl::unexpected(number.error());
  program_ = *std::move(program);
  numberProgram_ = *std::move(number);
  noAttributes_ = gl::VertexArray::create(tools_.api());
  const bool isWire = mode_ == DrawMode::kBackWireframe;
  pattern_ =
      FacePattern::create(tools_.api(), isWire ? FacePattern::kEdgeQuads : FacePattern::kHexagons);
  if (mode_ != DrawMode::kBackCharcoal) return {};
  auto grey = gl::Program::build(
      tools_.api(),
      "charcoal's front",
      common + std::string(kFattenGrey) + std::string(kGreyMain),
      kGreyFragment);
  if (!grey) return tl::unexpected(grey.error());
  greyProgram_ = *std::move(grey);
  return {};
}

Result<void>
BackFacesMethod::draw(const DrawRequest& request, const gl::Target& picture, FrameTimings&) {
  const gl::Api& api = tools_.api();
  const gl::Target::Options options{.size = request.fineSize(), .hasDepth = true};
  if (auto ok = tools_.fit(fine_, "the supersampled picture", options); !ok) return ok;
  const auto uploaded = faces_.upload(api, request.snapshot, tools_.mesh().center());
  if (!uploaded) return tl::unexpected(uploaded.error());
  if (mode_ == DrawMode::kBackCharcoal) faces_.uploadNormals(request.snapshot);
  if (auto ok = drawFirstLayer(request); !ok) return ok;
  api.enable(GL_DEPTH_TEST);
  api.depthFunc(GL_LEQUAL);
  if (mode_ == DrawMode::kBackCharcoal) drawGreyFront(request);
  drawBackFaces(request);
  api.disable(GL_DEPTH_TEST);
  tools_.reduce(fine_.color(), request.supersample, picture);
  return {};
}

Result<void> BackFacesMethod::drawFirstLayer(const DrawRequest& request) {
  const gl::Api& api = tools_.api();
  const FirstLayer asked = request.options.firstLayer;
  usesMarks_ = asked == FirstLayer::kNumbers ||
               (asked == FirstLayer::kAuto && !request.snapshot.model.closed);
  fine_.bind();
  api.clearColor(request.paper.x, request.paper.y, request.paper.z, 1.0F);
  if (usesMarks_) {
    findFirstLayer(request);
    api.clearColor(request.paper.x, request.paper.y, request.paper.z, 1.0F);
    api.clear(GL_COLOR_BUFFER_BIT);
    return {};
  }
  api.clear(GL_COLOR_BUFFER_BIT);
  api.colorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
  tools_.mesh().drawDepth(request.snapshot, request.camera, fine_);
  api.colorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  return {};
}

void BackFacesMethod::findFirstLayer(const DrawRequest& request) {
  const gl::Api& api = tools_.api();
  api.clearColor(0.0F, 0.0F, 0.0F, 0.0F);
  api.clearDepthf(1.0F);
  api.clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  api.enable(GL_DEPTH_TEST);
  api.depthFunc(GL_LESS);
  use(numberProgram_, request);
  drawFaces();
  api.disable(GL_DEPTH_TEST);
  const auto [width, height] = fine_.size();
  pixels_.resize(4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  api.pixelStorei(GL_PACK_ALIGNMENT, 1);
  api.readPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, pixels_.data());
  std::vector<std::uint8_t> marks(static_cast<std::size_t>(faces_.faceCount()), 0);
  for (std::size_t i = 0; i < pixels_.size(); i += 4) {
    const std::uint32_t number = pixels_[i] | std::uint32_t{pixels_[i + 1]} << 8 |
                                 std::uint32_t{pixels_[i + 2]} << 16 |
                                 std::uint32_t{pixels_[i + 3]} << 24;
    if (number - 1 < marks.size()) marks[number - 1] = 255;
  }
  faces_.uploadMarks(marks);
}

void BackFacesMethod::drawGreyFront(const DrawRequest& request) const {
  use(greyProgram_, request);
  greyProgram_.set("tone", kFrontTone);
  drawFaces();
}

void BackFacesMethod::drawBackFaces(const DrawRequest& request) const {
  const ModelDescription& model = request.snapshot.model;
  const auto radius = static_cast<float>(model.sphere.radius / model.grid.step);
  const float width = request.lineWidthPx();
  Change change = changeOf(mode_);
  if (mode_ == DrawMode::kBackWireframe) change.pullShare = kWirePull / width;
  use(program_, request);
  program_.set("grow", change.grow);
  program_.set("steepest", change.steepest);
  program_.set("pull", width * glm::vec2(change.pullShare, change.pullRadii * radius));
  program_.set("bySlope", change.bySlope);
  program_.set("mostBySlope", change.mostBySlope);
  program_.set("grazing", change.grazing);
  program_.set("tone", kStrokeTone);
  pattern_.draw(program_, faces_.faceCount());
}

void BackFacesMethod::use(const gl::Program& program, const DrawRequest& request) const {
  useFaceProgram(program, request, tools_, faces_);
  program.set("useFirstLayer", usesMarks_ ? 1 : 0);
}

void BackFacesMethod::drawFaces() const {
  tools_.api().bindVertexArray(noAttributes_.id());
  tools_.api().drawArrays(GL_TRIANGLES, 0, 3 * faces_.faceCount());
}

}  // namespace limn

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/render/style_store.h"
#include "client/stroke/tessellate.h"
#include "client/stroke/visibility/spine_samples.h"
#include "client/stroke/visibility/visibility.h"

#include "shared/core/camera.h"
#include "shared/gl/handles.h"
#include "shared/gl/program.h"
#include "shared/gl/target.h"

namespace limn {

/// Visibility along spines, and strokes of ink with it.
class StrokePass {
 public:
  /// Errors: kUnavailable.
  [[nodiscard]] static Result<StrokePass> create(const gl::Api& api);

  /// Most samples a frame can have.
  static constexpr std::uint32_t kMaxSamples = 1U << 20;

  /// Tests every sample against depth, as sampleVisibility (client/stroke/visibility/visibility.h).
  /// Errors: kUnavailable.
  [[nodiscard]] Result<void>
  findVisibility(const SpineSamples& samples, const gl::Texture& depth, int closedGap = kShortRun);

  /// What happens to hidden parts; the shader's numbers.
  enum class Hidden { kStyle = 0, kOff = 1, kAsVisible = 2 };

  struct DrawOptions {
    Viewport viewport;  // that the strokes' pixels count in
    Hidden hidden = Hidden::kStyle;
    float samplesPerPx = 1.0F;
    float widthPx = 1.0F;  // of an ordinary stroke
  };

  /// Finds where hidden lines are clear of visible ones (LineHalo), with the visibility found last,
  /// of the same samples; nothing where hidden lines have no style of their own. Errors:
  /// kUnavailable.
  [[nodiscard]] Result<void> findHalo(const SpineSamples& samples, const DrawOptions& options);

  /// Counts how densely lines lie (LineDensity), with the visibility found last, of the same
  /// samples. Errors: kUnavailable.
  [[nodiscard]] Result<void> findDensity(const SpineSamples& samples, const DrawOptions& options);

  /// Clears target (kRg8) and lays the ink on, with the visibility, halo and density found last:
  /// where lines crowd they are thinner, and hidden ones paler.
  void draw(
      const StrokeMesh& strokes,
      const LoadedStyle& style,
      const DrawOptions& options,
      const gl::Target& target) const;

  /// The visibility found last, 0 … 1 a sample, read back. For tests.
  [[nodiscard]] std::vector<float> readVisibility(std::size_t samples) const;
  /// The halo found last, read back: 1 where a hidden line is clear of visible ones. For tests.
  [[nodiscard]] std::vector<float> readClear(std::size_t samples) const;
  /// The density found last, read back: visible and hidden samples, cell after cell. For tests.
  [[nodiscard]] std::vector<glm::ivec2> readDensity() const;

 private:
  [[nodiscard]] std::vector<float>
  readAtlas(const gl::Target& atlas, std::size_t channel, std::size_t samples) const;

  static constexpr int kAtlasWidth = 512;  // samples a row
  static constexpr int kTexels = 3;        // of a sample

  const gl::Api* api_ = nullptr;
  gl::Program testProgram_;
  gl::Program voteProgram_;
  gl::Program drawnProgram_;
  gl::Program shapeProgram_;
  gl::Program haloMarkProgram_;
  gl::Program haloProgram_;
  gl::Program densityProgram_;
  gl::Program strokeProgram_;
  gl::VertexArray noAttributes_;
  gl::VertexArray strokeArray_;
  gl::Buffer vertices_;
  gl::Buffer indices_;
  // Grown when a frame needs more rows.
  int rows_ = 0;
  gl::Texture sampleTexture_;
  gl::Target shaped_;   // what is visible, a texel a sample
  gl::Target spare_;    // and at last that again, with where hidden lines are clear of visible ones
  gl::Target halo_;     // cells of the picture with visible lines
  gl::Target density_;  // visible and hidden samples in each cell of the picture
};

}  // namespace limn

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/render/drawing_method.h"
#include "client/render/stroke_pass.h"
#include "client/stroke/stroke_builder.h"

#include "shared/gl/program.h"

#include <memory>

namespace limn {

/// Stylised lines on paper; textures and brushes stay put on lines from frame to frame.
class StrokesMethod final : public DrawingMethod {
 public:
  /// Errors: kUnavailable.
  [[nodiscard]] static Result<std::unique_ptr<DrawingMethod>> create(DrawTools& tools);

  [[nodiscard]] Result<void>
  draw(const DrawRequest& request, const gl::Target& picture, FrameTimings& timings) override;

 private:
  explicit StrokesMethod(DrawTools& tools) : tools_(tools) {}

  void layOnPaper(const DrawRequest& request, const gl::Target& picture) const;

  DrawTools& tools_;
  StrokeBuilder builder_;
  StrokePass pass_;
  gl::Program paperProgram_;
  gl::Target ink_;  // supersampled, kRg8
};

}  // namespace limn

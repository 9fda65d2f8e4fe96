// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/render/drawing_method.h"

#include <memory>

namespace limn {

/// The mesh, lit; no lines.
class ShadedMethod final : public DrawingMethod {
 public:
  [[nodiscard]] static Result<std::unique_ptr<DrawingMethod>> create(DrawTools& tools);

  [[nodiscard]] Result<void>
  draw(const DrawRequest& request, const gl::Target& picture, FrameTimings& timings) override;

 private:
  explicit ShadedMethod(DrawTools& tools) : tools_(tools) {}

  DrawTools& tools_;
  gl::Target fine_;  // supersampled, colour and depth
};

}  // namespace limn

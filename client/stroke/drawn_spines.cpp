// SPDX-License-Identifier: Apache-2.0
#include "client/stroke/drawn_spines.h"

#include "client/stroke/bridges.h"
#include "client/stroke/fold_backs.h"

namespace limn {
namespace {

/// Points nearer than this in the picture are one.
constexpr float kMergePx = 0.35F;

/// Swallowtails are cut that reach so many widths of a stroke beyond where their branches meet.
constexpr float kFoldBackWidths = 2.0F;

/// Contours are joined over gaps of so many.
constexpr float kBridgeWidths = 5.0F;

}  // namespace

void DrawnSpines::find(
    const PolylineSet& lines,
    const LineScene& scene,
    const StrokeStyle& style,
    float widthPx) {
  projector_.project(lines, scene, kMergePx, spines);
  fadeLines(spines, style, scene, fades);
  dropFaded(spines, fades);
  cutFoldBacks(lines, scene, kFoldBackWidths * widthPx, spines);
  bridgeCusps(lines, scene, kBridgeWidths * widthPx, spines, fades);
}

}  // namespace limn

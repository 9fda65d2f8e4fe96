// SPDX-License-Identifier: Apache-2.0
#include "server/preprocess/hull_sections.h"

#include "protocol/framing.h"

#include "shared/codec/hull_codec.h"

namespace limn {
namespace {

struct Side {
  std::vector<std::uint8_t> section;
  protocol::SectionHash hash{};
};

Result<Side> encodeSide(const ProgressiveHull& hull, protocol::HullSide side) {
  const auto encoded = encodeHull(hull);
  if (!encoded) return tl::unexpected(encoded.error());
  Side made{.section = {}, .hash = protocol::sectionHash(encoded->base)};
  protocol::appendFrame(
      made.section,
      protocol::encodeMessage(protocol::Hull{.side = side, .draco = encoded->base}));
  std::uint32_t piece = 0;
  for (const auto& splits : encoded->pieces) {
    protocol::appendFrame(
        made.section,
        protocol::encodeMessage(
            protocol::HullSplits{.side = side, .piece = piece++, .splits = splits}));
  }
  return made;
}

}  // namespace

std::unique_ptr<const HullSections> encodeHullSections(const Hulls& hulls) {
  auto sections = std::make_unique<HullSections>();
  sections->reason = hulls.reason;
  if (hulls.outer) {
    const ProgressiveHull& outer = hulls.outer->hull;
    const ProgressiveHull& inner = hulls.inner->hull;
    auto outerBytes = encodeSide(outer, protocol::HullSide::kOuter);
    auto innerBytes = encodeSide(inner, protocol::HullSide::kInner);
    if (outerBytes && innerBytes) {
      sections->outer = std::move(outerBytes->section);
      sections->inner = std::move(innerBytes->section);
      sections->info.outerHash = outerBytes->hash;
      sections->info.innerHash = innerBytes->hash;
      sections->info.extraBits = static_cast<std::uint8_t>(hulls.extraBits);
      sections->info.outerBase = outer.facesAfter(0);
      sections->info.outerFinest = outer.facesAfter(outer.splits.size());
      sections->info.innerBase = inner.facesAfter(0);
      sections->info.innerFinest = inner.facesAfter(inner.splits.size());
    } else {
      sections->reason =
          "it cannot be coded: " + (outerBytes ? innerBytes : outerBytes).error().message;
    }
  }
  sections->info.reason = sections->reason;
  return sections;
}

}  // namespace limn

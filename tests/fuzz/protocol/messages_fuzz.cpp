// SPDX-License-Identifier: Apache-2.0
// Any bytes, from either side: decodeMessage() must refuse or give views inside the buffer.
#include "protocol/base_features.h"
#include "protocol/framing.h"
#include "protocol/messages.h"

#include <cstddef>
#include <cstdint>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace limn::protocol;
  for (const Sender sender : {Sender::kClient, Sender::kServer}) {
    const auto message = decodeMessage({data, size}, sender);
    if (!message) continue;
    // What decoded must survive its own encoding: equal values, equal bytes.
    const auto once = encodeMessage(message->body);
    const auto again = decodeMessage(once, sender);
    if (!again || encodeMessage(again->body) != once) __builtin_trap();
  }
  FrameReader frames({data, size});
  while (true) {
    const auto frame = frames.next();
    if (!frame || !*frame) break;
  }
  if (size > 0) (void)unpackBaseFeatures({data + 1, size - 1}, 3U * data[0]);
  return 0;
}

// SPDX-License-Identifier: Apache-2.0
#include "protocol/messages.h"

#include "protocol/limits.h"
#include "protocol/message_fields.h"
#include "protocol/read_messages.h"
#include "protocol/text.h"

#include <cstring>
#include <string>
#include <utility>

namespace limn::protocol {
namespace {

/// Deepest legal nesting: Message → Catalogue → vector → CatalogueEntry.
constexpr flatbuffers::uoffset_t kMaxDepth = 8;
constexpr flatbuffers::uoffset_t kMaxTables = limits::kMaxCatalogueModels + 8;
constexpr std::size_t kAlignment = alignof(std::uint64_t);

}  // namespace

Result<Message> decodeMessage(Bytes bytes, Sender sender) {
  const std::size_t limit =
      sender == Sender::kClient ? limits::kMaxClientMessageBytes : limits::kMaxServerMessageBytes;
  if (bytes.size() > limit) return tooLarge(std::to_string(bytes.size()) + " bytes");
  Message message;
  if (reinterpret_cast<std::uintptr_t>(bytes.data()) % kAlignment != 0) {
    message.realigned =
        std::make_unique<std::uint64_t[]>((bytes.size() + kAlignment - 1) / kAlignment);
    std::memcpy(message.realigned.get(), bytes.data(), bytes.size());
    bytes = {reinterpret_cast<const std::uint8_t*>(message.realigned.get()), bytes.size()};
  }
  // The shortest buffer with an identifier; the verifier reads that far without a look at the size.
  constexpr std::size_t kHeader =
      sizeof(flatbuffers::uoffset_t) + flatbuffers::kFileIdentifierLength;
  if (bytes.size() < kHeader) return bad("cut short");
  if (!wire::MessageBufferHasIdentifier(bytes.data())) {
    return bad("does not carry the identifier LIMN");
  }
  flatbuffers::Verifier verifier(bytes.data(), bytes.size(), kMaxDepth, kMaxTables);
  if (!wire::VerifyMessageBuffer(verifier)) return bad("the FlatBuffers verifier refuses it");
  const wire::Message& verified = *wire::GetMessage(bytes.data());
  auto body = sender == Sender::kClient ? readClientMessage(verified) : readServerMessage(verified);
  if (!body) return tl::unexpected(std::move(body).error());
  message.body = std::move(*body);
  return message;
}

bool isPayload(const Body& body) {
  return std::holds_alternative<Base>(body) || std::holds_alternative<LevelBlock>(body) ||
         std::holds_alternative<Packet>(body) || std::holds_alternative<Seeds>(body) ||
         std::holds_alternative<Hull>(body) || std::holds_alternative<HullSplits>(body) ||
         std::holds_alternative<Contour>(body) || std::holds_alternative<Map>(body);
}

std::optional<std::uint8_t> channelOf(const Body& body) {
  return std::visit(
      [](const auto& m) -> std::optional<std::uint8_t> {
        if constexpr (requires { m.channel; }) {
          if (m.channel < 0) return std::nullopt;
          return static_cast<std::uint8_t>(m.channel);
        } else {
          return std::nullopt;
        }
      },
      body);
}

std::string_view nameOf(const Body& body) {
  return wire::EnumNameBody(typeOf(body));
}

std::string_view nameOf(WireError code) {
  return wire::EnumNameErrorCode(code);
}

bool isValidModelName(std::string_view name) {
  return !name.empty() && isText(name, limits::kMaxNameBytes) &&
         name.find('/') == std::string_view::npos;
}

}  // namespace limn::protocol

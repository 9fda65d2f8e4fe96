// SPDX-License-Identifier: Apache-2.0
#include "client/view/catalogue.h"

#include "protocol/messages.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <utility>

namespace limn {
namespace {

using State = CatalogueEntry::State;

constexpr std::array<std::pair<std::string_view, State>, 4> kStates = {
    {{"queued", State::kQueued},
     {"preparing", State::kPreparing},
     {"ready", State::kReady},
     {"failed", State::kFailed}}};

template <class Value>
Value valueOr(const nlohmann::json& entry, const char* key, Value otherwise) {
  const auto found = entry.find(key);
  if (found == entry.end()) return otherwise;
  if constexpr (std::is_same_v<Value, std::string>) {
    return found->is_string() ? found->get<std::string>() : otherwise;
  } else {
    return found->is_number() ? found->get<Value>() : otherwise;
  }
}

}  // namespace

Result<std::vector<CatalogueEntry>> parseCatalogue(std::string_view text) {
  const auto json = nlohmann::json::parse(text, nullptr, false);
  if (!json.is_array()) {
    return fail(ErrorCode::kProtocol, "the server's list of models is not one: is it limn-server?");
  }
  std::vector<CatalogueEntry> entries;
  for (const auto& item : json) {
    if (!item.is_object()) continue;
    CatalogueEntry entry;
    entry.name = valueOr(item, "name", std::string());
    if (!protocol::isValidModelName(entry.name)) continue;
    const auto state = valueOr(item, "state", std::string());
    const auto* known =
        std::ranges::find(kStates, state, &std::pair<std::string_view, State>::first);
    if (known == kStates.end()) continue;
    entry.state = known->second;
    entry.progress = std::clamp(valueOr(item, "progress", 1.0), 0.0, 1.0);
    entry.reason = valueOr(item, "reason", std::string());
    entry.faces = valueOr(item, "faces", std::uint64_t{0});
    entries.push_back(std::move(entry));
  }
  return entries;
}

}  // namespace limn

// SPDX-License-Identifier: Apache-2.0
#include "client/core/session_state.h"

namespace limn {

std::string_view nameOf(MeshState state) {
  switch (state) {
    case MeshState::kNothing:
      return "none";
    case MeshState::kBase:
      return "base";
    case MeshState::kPartial:
      return "partial";
    case MeshState::kSettled:
      return "settled";
    case MeshState::kExact:
      return "exact";
    case MeshState::kComplete:
      return "complete";
  }
  return "none";
}

}  // namespace limn

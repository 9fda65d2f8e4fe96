// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

namespace limn {

/// What a client may see and open.
struct Grant {
  std::string subject;              // who it is, for logs; may be empty
  std::vector<std::string> models;  // names; one that ends with * stands for all that begin so

  [[nodiscard]] bool allows(std::string_view model) const {
    return std::ranges::any_of(models, [&](std::string_view name) {
      if (!name.ends_with('*')) return name == model;
      return model.starts_with(name.substr(0, name.size() - 1));
    });
  }
};

}  // namespace limn

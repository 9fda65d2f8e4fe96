// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/session/catalogue.h"

#include <memory>
#include <string_view>
#include <utility>
#include <vector>

namespace limn {

/// One model under every name, for sessions without a store.
class OneModel final : public ModelSource {
 public:
  explicit OneModel(std::shared_ptr<const Model> model) : model_(std::move(model)) {}

  [[nodiscard]] const std::vector<CatalogueItem>& catalogue() const override { return items_; }

  [[nodiscard]] Lookup find(std::string_view) override {
    return {Availability::kReady, model_, model_->forest().vertexCount(), ""};
  }

 private:
  std::shared_ptr<const Model> model_;
  std::vector<CatalogueItem> items_;
};

}  // namespace limn

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace limn {

/// While one lives, what this thread allocates with `new` adds up, and std::bad_alloc is thrown
/// before it comes to more than so many bytes: for decoders of others that allocate what a file
/// claims. What is freed is not given back. One a thread at a time. For this, the program's
/// `operator new` is replaced; sanitizers have their own, so there the budget does nothing.
class AllocationBudget {
 public:
  explicit AllocationBudget(std::size_t bytes);
  ~AllocationBudget();
  AllocationBudget(const AllocationBudget&) = delete;
  AllocationBudget& operator=(const AllocationBudget&) = delete;

  /// Whether it counts at all.
  [[nodiscard]] static bool works();
};

}  // namespace limn

// SPDX-License-Identifier: Apache-2.0
#include "shared/codec/allocation_budget.h"

#include "shared/core/assert.h"

#include <cstdint>
#include <cstdlib>
#include <new>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define LIMN_OWN_NEW 0
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || \
    __has_feature(memory_sanitizer)
#define LIMN_OWN_NEW 0
#endif
#endif
#ifndef LIMN_OWN_NEW
#define LIMN_OWN_NEW 1
#endif

namespace limn {
namespace {

constexpr std::size_t kNoBudget = SIZE_MAX;
thread_local constinit std::size_t bytesLeft = kNoBudget;

}  // namespace

AllocationBudget::AllocationBudget(std::size_t bytes) {
  LIMN_ASSERT(bytesLeft == kNoBudget && bytes != kNoBudget);
  bytesLeft = bytes;
}

AllocationBudget::~AllocationBudget() {
  bytesLeft = kNoBudget;
}

bool AllocationBudget::works() {
  return LIMN_OWN_NEW != 0;
}

#if LIMN_OWN_NEW
namespace {

void* allocate(std::size_t bytes) {
  if (bytesLeft != kNoBudget) {
    if (bytes > bytesLeft) throw std::bad_alloc();
    bytesLeft -= bytes;
  }
  void* memory = std::malloc(bytes == 0 ? 1 : bytes);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

}  // namespace
#endif

}  // namespace limn

#if LIMN_OWN_NEW
// The others (arrays, nothrow) call these [new.delete].
void* operator new(std::size_t bytes) {
  return limn::allocate(bytes);
}

void operator delete(void* memory) noexcept {
  std::free(memory);
}

void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}
#endif

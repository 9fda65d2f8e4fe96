// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tl/expected.hpp>

#include <string>
#include <string_view>
#include <utility>

namespace limn {

/// What kind of thing went wrong. Stable: exit codes and protocol errors are derived from it.
enum class ErrorCode {
  kInvalidArgument,  // the caller's or user's request makes no sense
  kNotFound,         // a file, model or asset does not exist
  kUnsupported,      // well-formed, but a feature Limn does not have
  kCorrupt,          // bytes that are not what they claim to be
  kLimitExceeded,    // larger than a stated limit
  kNonManifold,      // connectivity that an operation cannot keep manifold
  kIo,               // the operating system refused a read or write
  kNetwork,          // a connection failed or was lost
  kProtocol,         // the peer broke the protocol
  kUnavailable,      // not now: still preparing, draining, full
  kCancelled,        // stopped on request
};

/// Why an operation on outside data failed. `message` says what, where and what to do about it, in
/// one line a user can act on.
struct Error {
  ErrorCode code = ErrorCode::kInvalidArgument;
  std::string message;

  /// The same error seen from a caller: "context: message".
  [[nodiscard]] Error within(std::string_view context) const {
    return {code, std::string(context) + ": " + message};
  }
};

/// A value, or the reason there is none. Our code does not throw.
template <class T>
using Result = tl::expected<T, Error>;

/// Shorthand for returning an error: `return fail(ErrorCode::kCorrupt, "…");`
[[nodiscard]] inline tl::unexpected<Error> fail(ErrorCode code, std::string message) {
  return tl::unexpected<Error>(Error{code, std::move(message)});
}

}  // namespace limn

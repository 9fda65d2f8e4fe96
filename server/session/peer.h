// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace limn {

/// What a session needs of its connection. Sessions never push: the connection takes one message
/// from Session::nextMessage() whenever it can write, so nothing is buffered in between.
class Peer {
 public:
  virtual ~Peer() = default;
  /// Asks to be asked for the next message soon. Called on the loop thread, often.
  virtual void wantWrite() = 0;
};

}  // namespace limn

// SPDX-License-Identifier: Apache-2.0
#include "server/transport/ledger.h"

#include "server/transport/lws_transport.h"

#include <string>

namespace limn {

void Ledger::noteOpened(const Socket& socket) const {
  if (!happened_) return;
  happened_(
      {TransportEvent::Kind::kOpened,
       socket.connection->number(),
       socket.address,
       {},
       0.0,
       0,
       socket.subject()});
}

void Ledger::noteClosed(const Socket& socket, const Connection& connection, std::int64_t nowMs) {
  ++endings_[static_cast<std::size_t>(connection.ending())];
  if (!happened_) return;
  std::string why = nameOf(connection.ending());
  if (!connection.endingReason().empty()) why += ": " + connection.endingReason();
  happened_(
      {TransportEvent::Kind::kClosed,
       connection.number(),
       socket.address,
       why,
       static_cast<double>(nowMs - connection.bornMs()) / 1000.0,
       connection.payloadBytes(),
       socket.subject()});
}

void Ledger::tell(ServerStatus& status, std::int64_t nowMs) const {
  status.connectionsTotal = accepted_;
  for (std::size_t i = 0; i < endings_.size(); ++i)
    status.connectionsClosedTotal[nameOf(static_cast<Ending>(i))] = endings_[i];
  status.sentBytesTotal = traffic_.sentBytes;
  status.sentMessagesTotal = traffic_.sentMessages;
  status.receivedMessagesTotal = traffic_.receivedMessages;
  status.loopLag = loopLag_;
  status.uptimeSeconds = static_cast<double>(nowMs - startedMs_) / 1000.0;
}

}  // namespace limn

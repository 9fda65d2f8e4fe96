// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/net/lws_connection.h"
#include "client/view/catalogue.h"

#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

namespace limn {

/// A server's catalogue, read again every two seconds on a thread of its own: models appear while
/// they are being prepared. Threads: one.
class CatalogueWatch {
 public:
  /// whenNew: called on the watching thread.
  CatalogueWatch(LwsConnectionOptions server, std::function<void()> whenNew);
  ~CatalogueWatch();
  CatalogueWatch(const CatalogueWatch&) = delete;
  CatalogueWatch& operator=(const CatalogueWatch&) = delete;

  /// The newest one, once; a server that does not answer leaves the last one standing.
  [[nodiscard]] std::optional<std::vector<CatalogueEntry>> take();
  /// Why the last try failed; empty: it did not.
  [[nodiscard]] std::string complaint() const;

 private:
  void work();

  const LwsConnectionOptions server_;
  const std::function<void()> whenNew_;
  mutable std::mutex mutex_;
  std::condition_variable stop_;
  std::optional<std::vector<CatalogueEntry>> found_;
  std::string complaint_;
  bool stopping_ = false;
  std::thread thread_;  // last: it uses everything above
};

}  // namespace limn

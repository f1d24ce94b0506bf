#pragma once

#include <optional>

#include "serve/health.hpp"
#include "serve/http/http_message.hpp"

namespace planemap::service {

/// What is to be found where. Safe from any thread.
class HttpSite {
 public:
  explicit HttpSite(const Health& health) : health_(health) {}

  /// Answers that take no time and must come whatever else there is to do; empty: it is none of those.
  std::optional<HttpAnswer> quick_answer(const HttpRequest& request) const;
  /// Any answer.
  HttpAnswer answer(const HttpRequest& request);

 private:
  const Health& health_;
};

}  // namespace planemap::service

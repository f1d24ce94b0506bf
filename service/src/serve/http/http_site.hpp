#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "config/service_config.hpp"
#include "serve/health.hpp"
#include "serve/http/event_hub.hpp"
#include "serve/http/http_message.hpp"
#include "serve/http/live_view.hpp"
#include "serve/http/map_feed.hpp"
#include "serve/http/metrics.hpp"
#include "serve/status_board.hpp"

namespace planemap::service {

class Service;

/// Where the connection itself goes to the hub of events.
constexpr const char* kEventsPath = "/api/v1/events";

/// Those that are connected now.
struct ClientCounts {
  std::size_t connections = 0;
  std::size_t event_streams = 0;  ///< of the connections
};

/// What is to be found where (docs/http.md). Safe from any thread.
class HttpSite {
 public:
  /// @param service  outlives it
  HttpSite(const ServiceConfig& config, Service& service);
  ~HttpSite();
  HttpSite(const HttpSite&) = delete;
  HttpSite& operator=(const HttpSite&) = delete;

  /// Before the first request: whom to ask how many clients there are; from any thread.
  void set_client_counts(std::function<ClientCounts()> counts) { client_counts_ = std::move(counts); }
  /// Answers that take no time and must come whatever else there is to do; empty: it is none of those.
  std::optional<HttpAnswer> quick_answer(const HttpRequest& request) const;
  /// Any answer.
  HttpAnswer answer(const HttpRequest& request);
  /// What event streams are told; called while there are any.
  EventNews news(bool with_status);
  /// Lets go of what nobody has asked for in a while.
  void tidy_up();

 private:
  HttpAnswer planes(const HttpRequest& request);
  HttpAnswer plane(std::string_view id);
  HttpAnswer cells(const HttpRequest& request);
  HttpAnswer scan();
  HttpAnswer export_of(std::string_view name);
  HttpAnswer metrics();
  planemap_lcm::status_t status();

  Service& service_;
  const MapConfig map_config_;
  std::function<ClientCounts()> client_counts_;
  LiveView live_;
  Metrics metrics_;
  MapFeed feed_;
  std::mutex board_mutex_;
  StatusBoard board_;
  std::mutex document_mutex_;
  std::string document_etag_;
  std::shared_ptr<const std::string> document_;  ///< planes.json, and its tag
};

}  // namespace planemap::service

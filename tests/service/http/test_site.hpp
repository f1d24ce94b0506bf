#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

#include "serve/http/http_server.hpp"
#include "support/http_client.hpp"
#include "support/room_service.hpp"

namespace planemap::service {

/// On any free port, nearly always answering by the newest map.
inline ServiceConfig http_test_config() {
  ServiceConfig config = RoomService::default_config();
  config.http.listen = "127.0.0.1:0";
  config.http.update_period_s = 0.01;
  return config;
}

/// The whole service with its HTTP server, and a sensor on its bus.
class TestSite {
 public:
  explicit TestSite(const ServiceConfig& config = http_test_config()) : room_(config) {
    auto started = HttpServer::start(room_.config(), room_.service());
    if (!started) throw std::runtime_error(started.error().message);
    server_ = std::move(*started);
    room_.service().health().begin();
  }

  RoomService& room() { return room_; }
  Service& service() { return room_.service(); }
  HttpServer& server() { return *server_; }
  std::uint16_t port() const { return server_->port(); }
  HttpReply get(const std::string& target, const std::string& headers = {}) const {
    return http_get(port(), target, headers);
  }
  std::int64_t counter(const std::string& name) { return room_.service().counter_board().value(name); }

 private:
  RoomService room_;
  std::unique_ptr<HttpServer> server_;
};

/// Whether it holds within half a minute.
inline bool eventually(const std::function<bool()>& holds) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(30);
  while (!holds()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
  }
  return true;
}

}  // namespace planemap::service

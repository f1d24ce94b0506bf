#pragma once

#include <cstdint>
#include <memory>
#include <planemap/expected.hpp>
#include <string>

#include "config/service_config.hpp"

namespace planemap::service {

class Service;

/// The page of the map and what it asks, metrics and health, over HTTP/1.1; read only (docs/http.md). One thread has
/// the sockets, some work out answers from the newest snapshot; the mapper never waits for them.
class HttpServer {
 public:
  /// Listens and serves. The service must outlive the server. The error says which setting cannot be used,
  /// why, and what to do.
  /// @pre config.http.listen is not empty, and config has been checked
  static Expected<std::unique_ptr<HttpServer>> start(const ServiceConfig& config, Service& service);
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  std::uint16_t port() const;
  /// As a browser on this machine would be given it: http://127.0.0.1:7671/.
  std::string url() const;
  /// Closes all connections and ends, within a second unless an answer that takes longer has been begun. The destructor
  /// does it, too.
  void stop();

 private:
  class Impl;
  explicit HttpServer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace planemap::service

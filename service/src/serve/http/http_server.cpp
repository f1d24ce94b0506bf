#include "serve/http/http_server.hpp"

#include <spdlog/spdlog.h>

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <thread>
#include <utility>

#include "config/listen_address.hpp"
#include "serve/http/http_connection.hpp"
#include "serve/http/http_listener.hpp"
#include "serve/http/http_site.hpp"
#include "service.hpp"

namespace planemap::service {

namespace net = boost::asio;

class HttpServer::Impl {
 public:
  Impl(const ServiceConfig& config, ListenAddress address, Service& service)
      : address_(std::move(address)),
        site_(service.health()),
        pool_(static_cast<std::size_t>(config.http.threads),
              static_cast<std::size_t>(config.http.max_waiting_requests)),
        desk_{site_, pool_, service.counter_board(), address_.is_loopback()},
        listener_(io_, desk_, static_cast<std::size_t>(config.http.max_connections)) {}
  ~Impl() { stop(); }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  Expected<void> listen() { return listener_.listen_on(address_); }
  void serve() {
    listener_.start();
    thread_ = std::thread([this] { run(); });
  }
  void stop() {
    if (!thread_.joinable()) return;
    net::post(io_, [this] {
      listener_.stop();
      io_.stop();
    });
    thread_.join();
    pool_.stop();
  }
  std::uint16_t port() const { return listener_.port(); }
  std::string url() const {
    const bool is_v6 = address_.host.find(':') != std::string::npos;
    return "http://" + (is_v6 ? "[" + address_.host + "]" : address_.host) + ":" + std::to_string(port()) + "/";
  }

 private:
  /// A handler that throws costs its own connection.
  void run() {
    while (true) {
      try {
        io_.run();
        return;
      } catch (const std::exception& e) {
        spdlog::error("HTTP: a connection was given up: {}", e.what());
      }
    }
  }

  const ListenAddress address_;
  HttpSite site_;
  WorkerPool pool_;
  HttpDesk desk_;
  net::io_context io_{1};  ///< 1: one thread runs it
  net::executor_work_guard<net::io_context::executor_type> work_ = net::make_work_guard(io_);
  HttpListener listener_;
  std::thread thread_;
};

Expected<std::unique_ptr<HttpServer>> HttpServer::start(const ServiceConfig& config, Service& service) {
  auto address = parse_listen_address(config.http.listen);
  if (!address) return fail("http.listen: " + address.error().message);
  if (!address->is_loopback()) {
    if (!config.http.allow_remote) {
      return fail("http.listen: " + config.http.listen + " can be reached from other machines: http.allow_remote");
    }
    spdlog::warn("HTTP on {} is plain text without authentication: whoever reaches it can read the whole map",
                 config.http.listen);
  }
  auto impl = std::make_unique<Impl>(config, std::move(*address), service);
  if (auto listens = impl->listen(); !listens) return tl::make_unexpected(listens.error());
  impl->serve();
  return std::unique_ptr<HttpServer>(new HttpServer(std::move(impl)));
}

HttpServer::HttpServer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

HttpServer::~HttpServer() = default;

std::uint16_t HttpServer::port() const {
  return impl_->port();
}

std::string HttpServer::url() const {
  return impl_->url();
}

void HttpServer::stop() {
  impl_->stop();
}

}  // namespace planemap::service

#include "serve/http/http_server.hpp"

#include <spdlog/spdlog.h>

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
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
        site_(config, service),
        pool_(static_cast<std::size_t>(config.http.threads),
              static_cast<std::size_t>(config.http.max_waiting_requests)),
        hub_(io_, pool_, config.http, [this](bool with_status) { return site_.news(with_status); }),
        desk_{site_, pool_, hub_, service.counter_board(), address_.is_loopback()},
        listener_(io_, desk_, static_cast<std::size_t>(config.http.max_connections)) {
    site_.set_client_counts([this] { return ClientCounts{listener_.open(), hub_.size()}; });
  }
  ~Impl() { stop(); }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  Expected<void> listen() { return listener_.listen_on(address_); }
  void serve() {
    listener_.start();
    tidy_up_later();
    thread_ = std::thread([this] { run(); });
  }
  void stop() {
    if (!thread_.joinable()) return;
    net::post(io_, [this] {
      tidy_timer_.cancel();
      listener_.stop();
      hub_.stop();
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
  void tidy_up_later() {
    tidy_timer_.expires_after(std::chrono::seconds(5));
    tidy_timer_.async_wait([this](boost::system::error_code cancelled) {
      if (cancelled) return;
      pool_.try_post([this] { site_.tidy_up(); });
      tidy_up_later();
    });
  }

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
  net::io_context io_{1};  ///< 1: one thread runs it
  EventHub hub_;
  HttpDesk desk_;
  net::executor_work_guard<net::io_context::executor_type> work_ = net::make_work_guard(io_);
  HttpListener listener_;
  net::steady_timer tidy_timer_{io_};
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

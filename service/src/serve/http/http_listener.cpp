#include "serve/http/http_listener.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <boost/asio/ip/v6_only.hpp>
#include <boost/asio/write.hpp>
#include <chrono>
#include <utility>

#include "mapping/mapping_service.hpp"

namespace planemap::service {
namespace {

namespace net = boost::asio;
using boost::system::error_code;
using net::ip::tcp;

constexpr double kWarnPeriodS = 5.0;
constexpr std::chrono::milliseconds kRetry(100);

/// Open, bound and listening, or why not.
error_code open_socket(tcp::acceptor& acceptor, const tcp::endpoint& endpoint) {
  error_code error;
  acceptor.open(endpoint.protocol(), error);
  if (!error) acceptor.set_option(tcp::acceptor::reuse_address(true), error);
  if (!error && endpoint.address().is_v6()) acceptor.set_option(net::ip::v6_only(true), error);
  if (!error) acceptor.bind(endpoint, error);
  if (!error) acceptor.listen(net::socket_base::max_listen_connections, error);
  return error;
}

}  // namespace

HttpListener::HttpListener(net::io_context& io, HttpDesk& desk, std::size_t max_connections)
    : io_(io),
      desk_(desk),
      max_connections_(max_connections),
      repeats_(kWarnPeriodS),
      retry_(io),
      places_(std::make_shared<int>(0)) {}

Expected<void> HttpListener::listen_on(const ListenAddress& address) {
  tcp::resolver resolver(io_);
  error_code error;
  const auto found = resolver.resolve(address.host, std::to_string(address.port),
                                      tcp::resolver::passive | tcp::resolver::numeric_service, error);
  if (error) return fail("http.listen: " + address.host + " cannot be resolved: " + error.message());
  for (const auto& entry : found) {
    tcp::endpoint endpoint = entry.endpoint();
    if (port_ != 0) endpoint.port(port_);  // a name's other numbers get the port that the first one found
    auto acceptor = std::make_unique<Acceptor>(io_);
    if (const error_code why = open_socket(*acceptor, endpoint)) {
      error = why;
      if (why == net::error::address_in_use) break;
      continue;
    }
    port_ = acceptor->local_endpoint().port();
    acceptors_.push_back(std::move(acceptor));
    error.clear();
  }
  if (!acceptors_.empty() && !error) return {};
  std::string message = "http.listen: cannot listen on " + address.host + " port " + std::to_string(address.port) +
                        ": " + error.message();
  if (error == net::error::address_in_use) {
    message +=
        "; stop what listens there (another planemapd?), or choose another port, or none: --set "
        "http.listen=127.0.0.1:0 "
        "takes any free one, --set http.listen= does without the viewer";
  }
  return fail(std::move(message));
}

void HttpListener::start() {
  for (auto& acceptor : acceptors_) accept(*acceptor);
}

void HttpListener::stop() {
  for (auto& acceptor : acceptors_) acceptor->close();
  retry_.cancel();
  for (const auto& weak : connections_) {
    if (const auto connection = weak.lock()) connection->close();
  }
}

void HttpListener::accept(Acceptor& acceptor) {
  acceptor.async_accept([this, &acceptor](error_code error, tcp::socket socket) {
    if (!acceptor.is_open()) return;
    if (!error) {
      on_socket(std::move(socket));
      return accept(acceptor);
    }
    if (error != net::error::no_descriptors) return accept(acceptor);  // the client has gone again
    say("descriptors", "clients have to wait: no file descriptor is left (raise the limit of open files)");
    if (make_room()) return accept(acceptor);
    retry_.expires_after(kRetry);
    retry_.async_wait([this, &acceptor](error_code cancelled) {
      if (!cancelled) accept(acceptor);
    });
  });
}

/// Closes the connection that is idle for longest.
bool HttpListener::make_room() {
  std::shared_ptr<HttpConnection> oldest;
  for (auto at = connections_.begin(); at != connections_.end();) {
    const auto connection = at->lock();
    at = connection ? std::next(at) : connections_.erase(at);
    if (!connection || !connection->is_idle()) continue;
    if (!oldest || connection->idle_since_s() < oldest->idle_since_s()) oldest = connection;
  }
  if (!oldest) return false;
  connections_.remove_if([&](const auto& weak) { return weak.lock() == oldest; });
  oldest->close();
  desk_.counters.add("http.connections.closed_idle");
  return true;
}

void HttpListener::on_socket(tcp::socket socket) {
  // What was closed to make room holds its place until its handler has run, but no more of anything else.
  std::erase_if(connections_, [](const auto& weak) { return weak.expired(); });
  if (open() >= max_connections_ && !make_room()) {
    desk_.counters.add("http.connections.refused");
    say("full", "a client was refused: all " + std::to_string(max_connections_) +
                    " connections are being served (http.max_connections)");
    const HttpAnswer answer = error_answer(
        503, std::to_string(max_connections_) + " connections are being served already (http.max_connections)");
    const std::string text = head_of(answer, false) + *answer.body;
    error_code ignored;
    socket.non_blocking(true, ignored);  // it fits into the socket's buffer, or is not said
    socket.write_some(net::buffer(text), ignored);
    socket.shutdown(tcp::socket::shutdown_send, ignored);
    return;
  }
  error_code ignored;
  socket.set_option(tcp::no_delay(true), ignored);
  desk_.counters.add("http.connections.accepted");
  const auto connection = std::make_shared<HttpConnection>(std::move(socket), desk_, places_);
  connections_.push_back(connection);
  connection->start();
}

void HttpListener::say(const char* kind, const std::string& text) {
  const int count = repeats_.pass(kind, steady_now_s());
  if (count > 0) spdlog::warn("HTTP: {}{}", text, repeats_text(count));
}

}  // namespace planemap::service

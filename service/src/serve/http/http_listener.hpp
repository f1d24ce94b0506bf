#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <cstdint>
#include <list>
#include <memory>
#include <planemap/expected.hpp>
#include <string>
#include <vector>

#include "common/repeat_guard.hpp"
#include "config/listen_address.hpp"
#include "serve/http/http_connection.hpp"

namespace planemap::service {

/// The sockets that clients connect to. There are at most so many connections: for one more the one is closed that
/// waits for a request for longest (http.connections.closed_idle), and where none does the new one is told so and
/// closed (http.connections.refused). So clients that only sit there keep nobody out. On the I/O thread, but for the
/// constructor, listen_on() and what is const.
class HttpListener {
 public:
  HttpListener(boost::asio::io_context& io, HttpDesk& desk, std::size_t max_connections);

  /// Binds and listens. The error names the address, what the system says, and what to do.
  Expected<void> listen_on(const ListenAddress& address);
  std::uint16_t port() const { return port_; }

  void start();
  /// Accepts no more, and closes what there is.
  void stop();
  /// Connections that there are.
  std::size_t open() const { return static_cast<std::size_t>(places_.use_count() - 1); }

 private:
  using Acceptor = boost::asio::ip::tcp::acceptor;

  void accept(Acceptor& acceptor);
  void on_socket(boost::asio::ip::tcp::socket socket);
  bool make_room();
  void say(const char* kind, const std::string& text);

  boost::asio::io_context& io_;
  HttpDesk& desk_;
  const std::size_t max_connections_;
  std::uint16_t port_ = 0;
  RepeatGuard repeats_;
  boost::asio::steady_timer retry_;
  std::vector<std::unique_ptr<Acceptor>> acceptors_;  ///< a name may have several numbers
  std::list<std::weak_ptr<HttpConnection>> connections_;
  HttpPlace places_;  ///< shared by all who hold one
};

}  // namespace planemap::service

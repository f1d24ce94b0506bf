#pragma once

#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/parser.hpp>
#include <memory>
#include <optional>
#include <string>

#include "common/counters.hpp"
#include "serve/http/event_hub.hpp"
#include "serve/http/http_message.hpp"
#include "serve/http/http_site.hpp"
#include "serve/worker_pool.hpp"

namespace planemap::service {

/// What all connections of a server share; outlives them.
struct HttpDesk {
  HttpSite& site;
  WorkerPool& pool;
  EventHub& hub;
  Counters& counters;
  const bool is_loopback;  ///< the server is for this machine alone
};

/// One of the places that connections have; whoever holds it is counted.
using HttpPlace = std::shared_ptr<void>;

/// One client: reads requests and writes answers, one after the other. Answers are worked out on the pool; all else is
/// on the I/O thread. Every wait for the client ends: requests must be there whole in time, and pieces of answers
/// taken.
class HttpConnection : public std::enable_shared_from_this<HttpConnection> {
 public:
  HttpConnection(boost::asio::ip::tcp::socket socket, HttpDesk& desk, HttpPlace place);

  void start();
  /// Whether it waits for the client's next request, or for the client to go.
  bool is_idle() const { return is_idle_; }
  double idle_since_s() const { return idle_since_s_; }  ///< the host's steady clock
  void close();

 private:
  using Parser = boost::beast::http::request_parser<boost::beast::http::empty_body>;

  void read_request();
  void on_request(boost::beast::error_code error);
  HttpAnswer answer_to_broken(boost::beast::error_code error) const;
  void serve(const HttpRequest& request);
  void serve_events();
  void write(HttpAnswer answer);
  void write_body(std::size_t from);
  void after_write();
  void linger();
  void discard();
  void become_idle();

  boost::beast::tcp_stream stream_;
  HttpDesk& desk_;
  HttpPlace place_;
  boost::beast::flat_buffer buffer_;
  std::optional<Parser> parser_;
  bool is_idle_ = true;
  double idle_since_s_ = 0.0;
  bool is_head_only_ = false;
  bool keeps_alive_ = false;
  std::string head_;   ///< of the answer that is on its way
  HttpAnswer answer_;  ///< that is on its way
};

}  // namespace planemap::service

#include "serve/http/http_connection.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <boost/asio/buffer.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/http/error.hpp>
#include <boost/beast/http/read.hpp>
#include <chrono>
#include <utility>

#include "mapping/mapping_service.hpp"
#include "serve/http/http_request.hpp"

namespace planemap::service {
namespace {

namespace net = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
using beast::error_code;
using std::chrono::seconds;

constexpr seconds kRequestTimeout(10);  ///< until the next request is there whole
constexpr seconds kWriteTimeout(10);    ///< for each piece of an answer
constexpr seconds kLinger(1);
constexpr std::size_t kPieceBytes = 256 * 1024;

}  // namespace

HttpConnection::HttpConnection(net::ip::tcp::socket socket, HttpDesk& desk, HttpPlace place)
    : stream_(std::move(socket)), desk_(desk), place_(std::move(place)), buffer_(2 * kMaxHeadBytes) {
  become_idle();
}

void HttpConnection::become_idle() {
  is_idle_ = true;
  idle_since_s_ = steady_now_s();
}

void HttpConnection::start() {
  read_request();
}

void HttpConnection::close() {
  stream_.close();
}

void HttpConnection::read_request() {
  become_idle();
  parser_.emplace();
  parser_->header_limit(static_cast<std::uint32_t>(kMaxHeadBytes));
  parser_->body_limit(0);
  stream_.expires_after(kRequestTimeout);
  http::async_read_header(stream_, buffer_, *parser_,
                          [self = shared_from_this()](error_code error, std::size_t) { self->on_request(error); });
}

void HttpConnection::on_request(error_code error) {
  const bool is_broken = error && error.category() == make_error_code(http::error::bad_method).category() &&
                         error != http::error::end_of_stream && error != http::error::partial_message;
  if (error && !is_broken) return;  // the client has gone, or took too long
  is_idle_ = false;
  keeps_alive_ = false;
  is_head_only_ = false;
  if (error) return write(answer_to_broken(error));
  const auto& header = parser_->get();
  is_head_only_ = header.method() == http::verb::head;
  auto request = checked_request(header, desk_.is_loopback);
  if (!request) return write(std::move(request.error()));
  if (parser_->chunked()) return write(error_answer(413, "requests have no body here"));
  keeps_alive_ = parser_->keep_alive();
  serve(*request);
}

HttpAnswer HttpConnection::answer_to_broken(error_code error) const {
  if (error == http::error::header_limit || error == http::error::buffer_overflow) {
    return error_answer(431, "the request's line and headers are longer than " + std::to_string(kMaxHeadBytes) +
                                 " bytes, which is all that is taken");
  }
  if (error == http::error::body_limit) {
    const auto& header = parser_->get();
    const bool is_read = header.method() == http::verb::get || header.method() == http::verb::head;
    return is_read ? error_answer(413, "requests have no body here") : method_refused(header);
  }
  return error_answer(400, "this is no HTTP request: " + error.message());
}

void HttpConnection::serve(const HttpRequest& request) {
  if (request.path == kEventsPath) return serve_events();
  if (auto quick = desk_.site.quick_answer(request)) return write(std::move(*quick));
  const bool has_room = desk_.pool.try_post([self = shared_from_this(), request] {
    HttpAnswer answer;
    try {
      answer = self->desk_.site.answer(request);
    } catch (const std::exception& e) {
      spdlog::error("HTTP: {} could not be answered: {}", request.path, e.what());
      answer = error_answer(500, "planemapd failed at this: its log says more");
    }
    net::post(self->stream_.get_executor(),
              [self, answer = std::move(answer)]() mutable { self->write(std::move(answer)); });
  });
  if (has_room) return;
  write(error_answer(503, std::to_string(desk_.pool.capacity()) +
                              " requests wait already (http.max_waiting_requests); ask again later"));
}

/// The hub takes over, and this connection ends without closing.
void HttpConnection::serve_events() {
  keeps_alive_ = false;
  if (is_head_only_) return write(answer_of("text/event-stream", {}));
  if (!desk_.hub.has_room()) {
    return write(error_answer(
        503, std::to_string(desk_.hub.max_streams()) + " event streams are served already (http.max_event_streams)"));
  }
  desk_.counters.add("http.requests.200");
  stream_.expires_never();
  desk_.hub.add(std::move(stream_), std::move(place_));
}

void HttpConnection::write(HttpAnswer answer) {
  desk_.counters.add("http.requests." + std::to_string(answer.status));
  answer_ = std::move(answer);
  head_ = head_of(answer_, keeps_alive_);
  stream_.expires_after(kWriteTimeout);
  net::async_write(stream_, net::buffer(head_), [self = shared_from_this()](error_code error, std::size_t) {
    if (!error) self->write_body(0);
  });
}

/// Piece by piece: a client that reads slowly may take its time for the whole, but not stand still.
void HttpConnection::write_body(std::size_t from) {
  if (is_head_only_ || !answer_.body || from >= answer_.body->size()) return after_write();
  const std::size_t bytes = std::min(kPieceBytes, answer_.body->size() - from);
  stream_.expires_after(kWriteTimeout);
  net::async_write(stream_, net::buffer(answer_.body->data() + from, bytes),
                   [self = shared_from_this(), next = from + bytes](error_code error, std::size_t) {
                     if (!error) self->write_body(next);
                   });
}

void HttpConnection::after_write() {
  answer_ = {};
  if (keeps_alive_) return read_request();
  linger();
}

/// A socket that is closed while something of the client's is unread takes the answer back from it.
void HttpConnection::linger() {
  become_idle();
  error_code ignored;
  stream_.socket().shutdown(net::ip::tcp::socket::shutdown_send, ignored);
  buffer_.consume(buffer_.size());
  stream_.expires_after(kLinger);
  discard();
}

void HttpConnection::discard() {
  buffer_.consume(buffer_.size());
  stream_.async_read_some(buffer_.prepare(kMaxHeadBytes), [self = shared_from_this()](error_code error, std::size_t) {
    if (!error) self->discard();
  });
}

}  // namespace planemap::service

#include "serve/http/event_stream.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <boost/asio/buffer.hpp>
#include <boost/asio/write.hpp>
#include <chrono>
#include <nlohmann/json.hpp>
#include <utility>

#include "common/version.hpp"
#include "mapping/mapping_service.hpp"
#include "serve/http/http_message.hpp"

namespace planemap::service {
namespace {

namespace net = boost::asio;
using boost::beast::error_code;

constexpr std::chrono::seconds kWriteTimeout(10);  ///< for each piece
constexpr std::size_t kPieceBytes = 256 * 1024;

std::string hello_of(const MapSheet& sheet) {
  return fmt::format(R"({{"epoch":{},"revision":{},"frame":{},"version":"{}"}})", sheet.snapshot().epoch(),
                     sheet.snapshot().revision(), nlohmann::json(sheet.frame()).dump(), version());
}

}  // namespace

EventStream::EventStream(EventHub& hub, boost::beast::tcp_stream stream, std::shared_ptr<void> place)
    : hub_(hub), stream_(std::move(stream)), place_(std::move(place)), written_at_s_(steady_now_s()) {}

void EventStream::start() {
  text_ = "HTTP/1.1 200 OK\r\n" + common_headers() +
          "Content-Type: text/event-stream\r\nCache-Control: no-store\r\nConnection: close\r\n\r\n";
  is_writing_ = true;
  write_piece(0);
  watch_for_end();
}

void EventStream::offer(const EventNews& news) {
  news_.sheet = news.sheet;
  news_.pose = news.pose;
  news_.pose_utime = news.pose_utime;
  if (news.status) news_.status = news.status;
  step();
}

void EventStream::beat(double now_s, double heartbeat_s) {
  if (is_writing_ || now_s - written_at_s_ < heartbeat_s) return;
  text_ = ": heartbeat\n\n";
  is_writing_ = true;
  write_piece(0);
}

/// All that it has not been told.
std::string EventStream::next_text() {
  std::string text;
  if (news_.sheet) {
    const auto sheet = std::exchange(news_.sheet, nullptr);
    const MapSnapshot& snapshot = sheet->snapshot();
    if (!std::exchange(is_greeted_, true)) text += event_text("hello", hello_of(*sheet));
    const bool is_same_map = epoch_ == snapshot.epoch();
    const bool is_told = is_same_map && (sheet->serial() == serial_ ||
                                         (revision_ == snapshot.revision() && !sheet->has_cells_beyond(revision_)));
    if (!is_told) {
      text += event_text("delta", *sheet->delta_json(is_same_map ? std::optional(revision_) : std::nullopt));
    }
    epoch_ = snapshot.epoch();
    revision_ = snapshot.revision();
    serial_ = sheet->serial();
  }
  const auto pose = std::exchange(news_.pose, nullptr);
  if (pose && std::exchange(pose_utime_, news_.pose_utime) != news_.pose_utime) text += *pose;
  if (const auto status = std::exchange(news_.status, nullptr)) text += *status;
  return text;
}

void EventStream::step() {
  if (is_writing_) return;
  text_ = next_text();
  if (text_.empty()) return;
  is_writing_ = true;
  write_piece(0);
}

void EventStream::write_piece(std::size_t from) {
  if (from >= text_.size()) {
    is_writing_ = false;
    written_at_s_ = steady_now_s();
    return step();
  }
  const std::size_t bytes = std::min(kPieceBytes, text_.size() - from);
  stream_.expires_after(kWriteTimeout);
  net::async_write(stream_, net::buffer(text_.data() + from, bytes),
                   [self = shared_from_this(), next = from + bytes](error_code error, std::size_t) {
                     if (error) return self->end();
                     self->stream_.expires_never();
                     self->write_piece(next);
                   });
}

/// Clients have nothing to say here; this ends when they go.
void EventStream::watch_for_end() {
  stream_.socket().async_read_some(net::buffer(&ignored_, 1),
                                   [self = shared_from_this()](error_code error, std::size_t) {
                                     if (error) return self->end();
                                     self->watch_for_end();
                                   });
}

void EventStream::end() {
  close();
  hub_.remove(shared_from_this());
}

void EventStream::close() {
  stream_.close();
}

}  // namespace planemap::service

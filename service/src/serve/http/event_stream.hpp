#pragma once

#include <boost/beast/core/tcp_stream.hpp>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "serve/http/event_hub.hpp"

namespace planemap::service {

/// One client that is told of events. Writes one piece of text at a time; what happens meanwhile only replaces what it
/// is told next. A client that takes nothing for a while is given up. On the I/O thread.
class EventStream : public std::enable_shared_from_this<EventStream> {
 public:
  EventStream(EventHub& hub, boost::beast::tcp_stream stream, std::shared_ptr<void> place);

  void start();
  void offer(const EventNews& news);
  /// Tells it that nothing has happened, if it has been told nothing for so long.
  void beat(double now_s, double heartbeat_s);
  void close();

 private:
  void step();
  std::string next_text();
  void write_piece(std::size_t from);
  void watch_for_end();
  void end();

  EventHub& hub_;
  boost::beast::tcp_stream stream_;
  std::shared_ptr<void> place_;
  EventNews news_;  ///< not told yet
  bool is_greeted_ = false;
  std::optional<std::uint64_t> epoch_;  ///< of the map that it was told of
  std::uint64_t revision_ = 0;
  std::uint64_t serial_ = 0;     ///< of the sheet
  std::int64_t pose_utime_ = 0;  ///< of the pose that it was told of
  std::string text_;             ///< on its way
  bool is_writing_ = false;
  double written_at_s_ = 0.0;
  char ignored_ = 0;  ///< what clients say on such a connection
};

}  // namespace planemap::service

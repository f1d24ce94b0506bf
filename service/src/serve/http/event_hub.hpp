#pragma once

#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "config/service_config.hpp"
#include "serve/http/map_sheet.hpp"
#include "serve/worker_pool.hpp"

namespace planemap::service {

class EventStream;

/// What is to be told of one instant.
struct EventNews {
  std::shared_ptr<const MapSheet> sheet;
  std::shared_ptr<const std::string> pose;  ///< a whole event; nullptr: none is known
  std::int64_t pose_utime = 0;
  std::shared_ptr<const std::string> status;  ///< a whole event; nullptr: not yet again
};

/// An event of a stream. @param json  one line
std::string event_text(const char* name, const std::string& json);

/// All streams of events. Each has one state that it is to be brought to, and no queue: one that reads slowly gets the
/// changes of many revisions in one delta. While there are streams, a timer has the news made on the pool; else nothing
/// is done. On the I/O thread, but for the constructor and what is const.
class EventHub {
 public:
  /// Makes the news, on the pool; of one caller at a time.
  /// @param with_status  it is time for the status again
  using NewsMaker = std::function<EventNews(bool with_status)>;

  EventHub(boost::asio::io_context& io, WorkerPool& pool, const HttpConfig& config, NewsMaker make_news);
  ~EventHub();
  EventHub(const EventHub&) = delete;
  EventHub& operator=(const EventHub&) = delete;

  /// There is room for one more.
  bool has_room() const { return size_ < max_streams_; }
  std::size_t max_streams() const { return max_streams_; }
  std::size_t size() const { return size_; }
  /// Takes over a connection that has asked for events. @param place  given up with it
  void add(boost::beast::tcp_stream stream, std::shared_ptr<void> place);
  void stop();

 private:
  friend class EventStream;
  void remove(const std::shared_ptr<EventStream>& stream);
  void wait();
  void ask_for_news();
  void on_news(const EventNews& news);

  WorkerPool& pool_;
  const std::size_t max_streams_;
  const double period_s_;
  const double heartbeat_s_;
  const NewsMaker make_news_;
  boost::asio::steady_timer timer_;
  std::set<std::shared_ptr<EventStream>> streams_;
  std::atomic<std::size_t> size_ = 0;  ///< of streams_
  bool is_stopped_ = false;
  bool is_waiting_ = false;  ///< for the timer, or for the pool
  double status_at_s_ = 0.0;
};

}  // namespace planemap::service

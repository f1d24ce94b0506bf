#include "serve/http/event_hub.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <boost/asio/post.hpp>
#include <chrono>
#include <exception>
#include <utility>

#include "mapping/mapping_service.hpp"
#include "serve/http/event_stream.hpp"

namespace planemap::service {
namespace {

namespace net = boost::asio;

constexpr double kStatusPeriodS = 1.0;

}  // namespace

std::string event_text(const char* name, const std::string& json) {
  return std::string("event: ") + name + "\ndata: " + json + "\n\n";
}

EventHub::EventHub(net::io_context& io, WorkerPool& pool, const HttpConfig& config, NewsMaker make_news)
    : pool_(pool),
      max_streams_(static_cast<std::size_t>(config.max_event_streams)),
      period_s_(std::min(config.update_period_s, config.heartbeat_s)),
      heartbeat_s_(config.heartbeat_s),
      make_news_(std::move(make_news)),
      timer_(io) {}

EventHub::~EventHub() = default;

void EventHub::add(boost::beast::tcp_stream stream, std::shared_ptr<void> place) {
  const auto added = std::make_shared<EventStream>(*this, std::move(stream), std::move(place));
  if (is_stopped_) return;
  streams_.insert(added);
  size_ = streams_.size();
  status_at_s_ = 0.0;  // a new one wants to know
  added->start();
  if (!is_waiting_) ask_for_news();
}

void EventHub::remove(const std::shared_ptr<EventStream>& stream) {
  streams_.erase(stream);
  size_ = streams_.size();
}

void EventHub::stop() {
  is_stopped_ = true;
  timer_.cancel();
  for (const auto& stream : streams_) stream->close();
  streams_.clear();
  size_ = 0;
}

void EventHub::wait() {
  is_waiting_ = true;
  timer_.expires_after(
      std::chrono::duration_cast<net::steady_timer::duration>(std::chrono::duration<double>(period_s_)));
  timer_.async_wait([this](boost::system::error_code cancelled) {
    if (!cancelled) ask_for_news();
  });
}

void EventHub::ask_for_news() {
  is_waiting_ = !streams_.empty() && !is_stopped_;
  if (!is_waiting_) return;
  const double now_s = steady_now_s();
  const bool with_status = now_s - status_at_s_ >= kStatusPeriodS;
  if (with_status) status_at_s_ = now_s;
  const bool has_room = pool_.try_post([this, with_status] {
    EventNews news;
    try {
      news = make_news_(with_status);
    } catch (const std::exception& e) {
      spdlog::error("HTTP: events could not be made: {}", e.what());
    }
    net::post(timer_.get_executor(), [this, news = std::move(news)] { on_news(news); });
  });
  if (!has_room) wait();  // the pool is full: later
}

void EventHub::on_news(const EventNews& news) {
  if (is_stopped_) return;
  const double now_s = steady_now_s();
  const auto streams = streams_;  // one may end meanwhile
  for (const auto& stream : streams) {
    if (news.sheet) stream->offer(news);
    stream->beat(now_s, heartbeat_s_);
  }
  wait();
}

}  // namespace planemap::service

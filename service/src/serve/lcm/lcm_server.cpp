#include "serve/lcm/lcm_server.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <utility>

#include "common/background.hpp"
#include "common/clock.hpp"

namespace planemap::service {
namespace {

constexpr std::size_t kMaxRequests = 64;  // that wait for an answer
constexpr std::size_t kMaxJobs = 16;      // answers that wait for their turn on the bus
constexpr int kNice = 5;                  // of both threads: a third of the mapper's share of a core that is full
constexpr double kLogPeriodS = 1.0;
constexpr double kWarnPeriodS = 5.0;

}  // namespace

LcmServer::LcmServer(const ServiceConfig& config, lcm::LCM& bus, const MappingService& mapping, PlaneBook& book,
                     StatusBoard board, Counters& counters)
    : config_(config.publish),
      bus_(bus),
      mapping_(mapping),
      board_(std::move(board)),
      counters_(counters),
      answerer_(config, book),
      deltas_(config, book),
      clouds_(config, book),
      outbox_(config.publish.page_pause_s),
      publish_repeats_(kWarnPeriodS),
      request_repeats_(kWarnPeriodS),
      answering_([this](const std::stop_token& stop) { run_answers(stop); }),
      publishing_([this](const std::stop_token& stop) { run(stop); }) {}

LcmServer::~LcmServer() {
  stop();
}

void LcmServer::stop() {
  for (auto* thread : {&answering_, &publishing_}) thread->request_stop();
  for (auto* thread : {&answering_, &publishing_}) {
    if (thread->joinable()) thread->join();
  }
}

void LcmServer::on_request(std::span<const std::uint8_t> message) {
  counters_.add("requests.received");
  auto request = decode_request(message);
  if (!request) return reject(request.error().reason, request.error().message);
  {
    const std::lock_guard lock(mutex_);
    if (requests_.size() >= kMaxRequests) {
      counters_.add("requests.dropped.queue_full");
      return;
    }
    requests_.push_back(std::move(*request));
  }
  work_.notify_one();
}

void LcmServer::reject(const std::string& reason, const std::string& message) {
  counters_.add("requests.rejected." + reason);
  const int count = request_repeats_.pass(reason, steady_now_s());
  if (count > 0) spdlog::warn("channel {}: {}{}", config_.request_channel, message, repeats_text(count));
}

void LcmServer::wake() {
  {
    const std::lock_guard lock(mutex_);
    is_woken_ = true;
  }
  woken_.notify_one();
}

planemap_lcm::status_t LcmServer::status() {
  const std::lock_guard lock(board_mutex_);
  return board_.status(steady_now_s(), utime_now());
}

void LcmServer::run_answers(const std::stop_token& stop) {
  run_in_background(kNice);
  while (!stop.stop_requested()) {
    Request request;
    {
      std::unique_lock lock(mutex_);
      const auto can_work = [this] { return !requests_.empty() && answers_.size() + jobs_ < kMaxJobs; };
      if (!work_.wait(lock, stop, can_work)) return;
      request = std::move(requests_.front());
      requests_.pop_front();
    }
    try {
      answer(request);
    } catch (const std::exception& e) {
      // What could not be answered is gone; the service goes on.
      counters_.add("requests.errors");
      spdlog::error("a request on {} could not be answered: {}", request.reply_channel, e.what());
    }
  }
}

void LcmServer::answer(const Request& request) {
  auto reply = answerer_.answer(
      request, mapping_.snapshot(), [this] { return status(); }, utime_now());
  counters_.add(reply.error.empty() ? "requests.answered" : "requests.answered_with_error");
  if (reply.has_failed) {
    counters_.add("requests.errors");
    spdlog::error("request {} on {}: {}", request.request_id, request.reply_channel, reply.error);
  } else if (!reply.error.empty()) {
    spdlog::debug("request {} on {}: {}", request.request_id, request.reply_channel, reply.error);
  }
  {
    const std::lock_guard lock(mutex_);
    answers_.push_back(std::move(reply));
    is_woken_ = true;
  }
  woken_.notify_one();
}

void LcmServer::run(const std::stop_token& stop) {
  // Outlines for a delta may take as long as a scan. Where there is one core, scans that wait for them would wait on
  // and on; this way a delta is late, or tells of two scans.
  run_in_background(kNice);
  while (!stop.stop_requested()) {
    try {
      take_answers();
      publish_due(steady_now_s());
    } catch (const std::exception& e) {
      // What could not be answered is gone; the service goes on.
      counters_.add("publish.errors");
      spdlog::error("publishing failed: {}", e.what());
    }
    const double wait_s = std::max(0.0, next_due_s() - steady_now_s());
    std::unique_lock lock(mutex_);
    woken_.wait_for(lock, stop, std::chrono::duration<double>(wait_s), [this] { return is_woken_; });
    is_woken_ = false;
  }
}

bool LcmServer::has_delta() const {
  const auto snapshot = mapping_.snapshot();
  return snapshot->epoch() != told_epoch_ || snapshot->revision() != told_revision_;
}

double LcmServer::next_due_s() const {
  double due_s = std::min(status_due_s_, log_due_s_);
  if (has_delta() && outbox_.jobs() < kMaxJobs) due_s = std::min(due_s, delta_due_s_);
  if (!config_.point_cloud_channel.empty()) due_s = std::min(due_s, cloud_due_s_);
  if (!outbox_.empty()) due_s = std::min(due_s, outbox_.due_s());
  return due_s;
}

/// The answers that are there go into the outbox, and whoever answers learns how much room there is.
void LcmServer::take_answers() {
  {
    const std::lock_guard lock(mutex_);
    for (auto& reply : answers_) outbox_.add(std::move(reply));
    answers_.clear();
    jobs_ = outbox_.jobs();
  }
  work_.notify_one();
}

void LcmServer::publish_due(double now_s) {
  if (now_s >= status_due_s_) {
    status_due_s_ = now_s + config_.status_period_s;
    publish(config_.status_channel, encode(status()));
  }
  if (now_s >= log_due_s_) {
    log_due_s_ = now_s + kLogPeriodS;
    const std::lock_guard lock(board_mutex_);
    board_.log(now_s);
  }
  if (now_s >= delta_due_s_ && outbox_.jobs() < kMaxJobs && has_delta()) {
    delta_due_s_ = now_s + config_.delta_period_s;
    const auto snapshot = mapping_.snapshot();
    told_epoch_ = snapshot->epoch();
    told_revision_ = snapshot->revision();
    outbox_.add(config_.delta_channel, deltas_.make(snapshot));
  }
  if (!config_.point_cloud_channel.empty() && now_s >= cloud_due_s_) {
    cloud_due_s_ = now_s + config_.point_cloud_period_s;
    publish(config_.point_cloud_channel, clouds_.make(mapping_.snapshot()));
  }
  if (!outbox_.empty() && now_s >= outbox_.due_s()) {
    const auto message = outbox_.take(now_s, utime_now());
    publish(message.channel, message.bytes);
  }
}

void LcmServer::publish(const std::string& channel, const Page& bytes) {
  if (bus_.publish(channel, bytes.data(), static_cast<unsigned>(bytes.size())) == 0) return;
  counters_.add("publish.failed");
  const int count = publish_repeats_.pass(channel, steady_now_s());
  if (count > 0) {
    spdlog::warn("{} bytes could not be sent on {}; is there a route for multicast?{}", bytes.size(), channel,
                 repeats_text(count));
  }
}

}  // namespace planemap::service

#include "lcm/lcm_requester.hpp"

#include <algorithm>
#include <cstdio>
#include <random>
#include <utility>

#include "deadline.hpp"
#include "lcm/reply_codec.hpp"

namespace planemap::client {
namespace {

using planemap_lcm::reply_t;
using planemap_lcm::request_t;
using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

// The service paces the pages of an answer; so many may wait here while this side is held up. liblcm's own default of
// 30 drops the newest.
constexpr int kQueuedMessages = 4096;
constexpr std::size_t kMissingAskedAtOnce = 32;

std::uint64_t random_number() {
  std::random_device random;
  return (static_cast<std::uint64_t>(random()) << 32u) | random();
}

std::string random_reply_channel() {
  char name[32];
  std::snprintf(name, sizeof name, "PLANEMAP_REPLY_%016llx", static_cast<unsigned long long>(random_number()));
  return name;
}

tl::unexpected<Error> no_network(std::string message) {
  return tl::make_unexpected(Error{Error::Kind::kNoNetwork, std::move(message)});
}

}  // namespace

LcmRequester::LcmRequester(std::shared_ptr<lcm::LCM> bus, const LcmClientOptions& options)
    : bus_(std::move(bus)),
      options_(options),
      reply_channel_(random_reply_channel()),
      next_id_(static_cast<std::int64_t>(random_number() >> 2u)),
      collector_(0) {
  subscription_ = bus_->subscribe(reply_channel_, &LcmRequester::on_reply, this);
  if (subscription_ != nullptr) subscription_->setQueueCapacity(kQueuedMessages);
}

LcmRequester::~LcmRequester() {
  if (subscription_ != nullptr) bus_->unsubscribe(subscription_);
}

void LcmRequester::note_malformed(std::string why) {
  ++malformed_;
  last_malformed_ = std::move(why);
}

void LcmRequester::on_reply(const lcm::ReceiveBuffer* buffer, const std::string& /*channel*/) noexcept {
  try {
    auto reply = decode_reply({static_cast<const std::uint8_t*>(buffer->data), buffer->data_size});
    if (!reply) return note_malformed(reply.error());
    const PageCollector::Outcome outcome = collector_.add(std::move(*reply));
    refused_ = refused_ || outcome == PageCollector::Outcome::kError;
    contradicted_ = contradicted_ || outcome == PageCollector::Outcome::kContradiction;
  } catch (...) {  // C code is on the stack; only memory can have run out
    ++malformed_;
  }
}

bool LcmRequester::send(const request_t& question, std::int32_t page) {
  request_t request = question;
  request.utime =
      std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::system_clock::now().time_since_epoch())
          .count();
  request.request_id = collector_.request_id();
  request.reply_channel = reply_channel_;
  if (page >= 0) {
    request.epoch = collector_.epoch();
    request.revision = collector_.revision();
  }
  request.page = page;
  return bus_->publish(options_.request_channel, &request) == 0;
}

/// Sends the request under a new id, so that pages of earlier tries can't mix with those to come.
bool LcmRequester::begin(const request_t& question) {
  collector_ = PageCollector(next_id_++);
  refused_ = false;
  contradicted_ = false;
  return send(question, -1);
}

/// Nothing came for a while: the whole request again, or the pages that are missing.
bool LcmRequester::ask_again(const request_t& question) {
  if (!collector_.any()) return begin(question);
  const auto missing = collector_.missing(kMissingAskedAtOnce);
  return std::all_of(missing.begin(), missing.end(), [&](std::int32_t page) { return send(question, page); });
}

tl::unexpected<Error> LcmRequester::gave_up(milliseconds timeout) const {
  const std::string within = " within " + seconds_text(timeout);
  if (collector_.any()) {
    return tl::make_unexpected(Error{Error::Kind::kIncomplete, "only " + std::to_string(collector_.received()) +
                                                                   " of " + std::to_string(collector_.page_count()) +
                                                                   " pages of the answer came" + within});
  }
  if (malformed_ > 0) {
    return tl::make_unexpected(
        Error{Error::Kind::kMalformed, "no answer that can be read came" + within + " (" + last_malformed_ + ")"});
  }
  return tl::make_unexpected(
      Error{Error::Kind::kUnreachable, "no planemap service answered on " + options_.request_channel + within});
}

Expected<std::vector<reply_t>> LcmRequester::ask(const request_t& question, milliseconds timeout) {
  const auto not_sent = [] {
    return no_network("LCM can't send: is there a route for multicast? (ip route add 224.0.0.0/4 dev lo)");
  };
  const Clock::time_point deadline = Clock::now() + timeout;
  if (subscription_ == nullptr) return no_network("LCM can't subscribe to " + reply_channel_);
  if (!begin(question)) return not_sent();
  Clock::time_point ask_again_at = Clock::now() + options_.ask_again_after;
  while (!collector_.complete()) {
    const Clock::time_point now = Clock::now();
    if (now >= deadline) return gave_up(timeout);
    const bool gone = refused_ && collector_.error().status == reply_t::STATUS_GONE;
    if (refused_ && !gone) {
      return tl::make_unexpected(
          Error{Error::Kind::kRefused, "the service refused the request: " + collector_.error().error});
    }
    if (gone && question.epoch != 0) {  // it will not come back
      return tl::make_unexpected(Error{Error::Kind::kGone, collector_.error().error});
    }
    if (gone || contradicted_) {  // the map went on, or was replaced, between two pages
      if (!begin(question)) return not_sent();
      ask_again_at = now + options_.ask_again_after;
    } else if (now >= ask_again_at) {
      if (!ask_again(question)) return not_sent();
      ask_again_at = now + (collector_.any() ? options_.lost_page_after : options_.ask_again_after);
    }
    const auto wait = std::chrono::ceil<milliseconds>(std::min(deadline, ask_again_at) - now);
    const std::size_t before = collector_.received();
    if (bus_->handleTimeout(static_cast<int>(std::max<std::int64_t>(wait.count(), 1))) < 0) {
      return no_network("LCM failed while it waited for the answer");
    }
    if (collector_.received() != before) ask_again_at = Clock::now() + options_.lost_page_after;
  }
  return collector_.take();
}

}  // namespace planemap::client

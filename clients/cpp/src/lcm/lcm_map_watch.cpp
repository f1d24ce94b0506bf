#include "lcm/lcm_map_watch.hpp"

#include <algorithm>
#include <planemap_lcm/request_t.hpp>
#include <span>
#include <utility>

#include "deadline.hpp"
#include "lcm/query_requests.hpp"
#include "lcm/reply_codec.hpp"

namespace planemap::client {
namespace {

using std::chrono::milliseconds;

constexpr int kQueuedMessages = 4096;
constexpr std::size_t kMostWaiting = 16;  // deltas that do not connect to what is known

bool ran_out_of_time(const Error& error) {
  return error.kind == Error::Kind::kUnreachable || error.kind == Error::Kind::kIncomplete;
}

std::span<const std::uint8_t> bytes_of(const lcm::ReceiveBuffer* buffer) {
  return {static_cast<const std::uint8_t*>(buffer->data), buffer->data_size};
}

}  // namespace

LcmMapWatch::LcmMapWatch(LcmRequester& requester) : requester_(requester), heard_at_(Clock::now()) {
  deltas_ = requester.bus().subscribe(requester.options().delta_channel, &LcmMapWatch::on_delta, this);
  statuses_ = requester.bus().subscribe(requester.options().status_channel, &LcmMapWatch::on_status, this);
  if (deltas_ != nullptr) deltas_->setQueueCapacity(kQueuedMessages);
}

LcmMapWatch::~LcmMapWatch() {
  for (auto* subscription : {deltas_, statuses_}) {
    if (subscription != nullptr) requester_.bus().unsubscribe(subscription);
  }
}

void LcmMapWatch::on_delta(const lcm::ReceiveBuffer* buffer, const std::string& /*channel*/) noexcept {
  try {
    auto page = decode_delta(bytes_of(buffer));
    if (!page) return requester_.note_malformed(page.error());
    heard_at_ = Clock::now();
    const MapVersion version{page->epoch, page->revision};
    const bool is_coming = due_ && due_->version.epoch == version.epoch && due_->version.revision == version.revision;
    if (is_coming) due_.reset();  // each page of it gives those behind it time
    expect(version, heard_at_ + requester_.options().lost_page_after);
    if (auto delta = collector_.add(std::move(*page))) {
      if (waiting_.size() == kMostWaiting) waiting_.pop_front();
      waiting_.push_back(std::move(*delta));
    }
  } catch (...) {  // C code is on the stack; only memory can have run out
    requester_.note_malformed("a delta could not be held");
  }
}

void LcmMapWatch::on_status(const lcm::ReceiveBuffer* buffer, const std::string& /*channel*/) noexcept {
  try {
    const auto version = decode_status_version(bytes_of(buffer));
    if (!version) return requester_.note_malformed(version.error());
    heard_at_ = Clock::now();
    expect(*version, heard_at_ + requester_.options().lost_delta_after);
  } catch (...) {
    requester_.note_malformed("a status could not be held");
  }
}

/// Notes that there is a revision, and until when it must have come. The first one that is missing counts, and the
/// first time that it was told of: news of it may come more often than it is waited for.
void LcmMapWatch::expect(MapVersion version, Clock::time_point until) {
  if (!mirror_.has_map()) return;
  const bool is_known = version.epoch == mirror_.map().epoch && version.revision <= mirror_.map().revision;
  if (is_known) return;
  if (!due_) due_ = Due{version, until};
}

/// Applies the deltas that connect to what is known; until one of them changes something.
std::optional<MapChange> LcmMapWatch::change_by_delta() {
  const auto fits = [this](const Delta& delta) { return mirror_.fits(delta); };
  for (;;) {
    const auto next = std::find_if(waiting_.begin(), waiting_.end(), fits);
    if (next == waiting_.end()) return std::nullopt;
    Delta delta = std::move(*next);
    waiting_.erase(next);
    MapChange change = mirror_.apply(std::move(delta));
    forget_what_is_known();
    if (!change.empty()) return change;
  }
}

Expected<MapChange> LcmMapWatch::change_by_snapshot(milliseconds timeout) {
  auto map = requester_.ask(request_for(planemap_lcm::request_t::OPERATION_SNAPSHOT), timeout).map(map_of);
  if (!map) return tl::make_unexpected(map.error());
  heard_at_ = Clock::now();
  due_.reset();
  MapChange change = mirror_.replace(std::move(*map));
  forget_what_is_known();
  return change;
}

void LcmMapWatch::forget_what_is_known() {
  const Map& map = mirror_.map();
  waiting_.erase(std::remove_if(waiting_.begin(), waiting_.end(),
                                [&](const Delta& delta) {
                                  return delta.epoch < map.epoch ||
                                         (delta.epoch == map.epoch && delta.revision <= map.revision);
                                }),
                 waiting_.end());
  const bool is_known = due_ && due_->version.epoch == map.epoch && due_->version.revision <= map.revision;
  if (is_known) due_.reset();
}

/// @return false: the bus failed
bool LcmMapWatch::wait_until(Clock::time_point time) {
  const auto wait = std::chrono::ceil<milliseconds>(time - Clock::now());
  return requester_.bus().handleTimeout(static_cast<int>(std::max<std::int64_t>(wait.count(), 1))) >= 0;
}

Expected<MapChange> LcmMapWatch::next(milliseconds timeout) {
  if (deltas_ == nullptr || statuses_ == nullptr) {
    return tl::make_unexpected(Error{Error::Kind::kNoNetwork, "LCM can't subscribe to deltas and status"});
  }
  const auto begin = Clock::now();
  const auto deadline = begin + timeout;
  for (;;) {
    if (auto change = change_by_delta()) return *change;
    auto now = Clock::now();
    if (!mirror_.has_map() || (due_ && now >= due_->until)) {
      auto left = std::max(std::chrono::ceil<milliseconds>(deadline - now), milliseconds(1));
      if (mirror_.has_map()) left = std::max(left, requester_.options().catch_up_for);
      auto change = change_by_snapshot(left);
      now = Clock::now();
      const bool is_to_be_told = !change || !change->empty();
      const bool may_come_yet = !change && mirror_.has_map() && ran_out_of_time(change.error()) &&
                                now - heard_at_ < requester_.options().silent_after;
      if (is_to_be_told && !may_come_yet) return change;
    }
    const auto silent_after = requester_.options().silent_after;
    const bool is_silent =
        now - std::max(heard_at_, begin) >= silent_after || (now >= deadline && now - heard_at_ >= silent_after);
    if (is_silent) {
      return tl::make_unexpected(Error{Error::Kind::kUnreachable, "nothing was heard of a planemap service on " +
                                                                      requester_.options().status_channel + " for " +
                                                                      seconds_text(silent_after)});
    }
    if (now >= deadline) return mirror_.no_change();
    auto wake_at = std::min(deadline, std::max(heard_at_, begin) + silent_after);
    if (due_) wake_at = std::min(wake_at, due_->until);
    if (!wait_until(wake_at)) {
      return tl::make_unexpected(Error{Error::Kind::kNoNetwork, "LCM failed while it waited for news"});
    }
  }
}

}  // namespace planemap::client

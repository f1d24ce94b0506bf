#include "grpc_map_watch.hpp"

#include <algorithm>
#include <thread>
#include <utility>
#include <variant>

#include "deadline.hpp"
#include "map_stream.hpp"
#include "proto_answers.hpp"

namespace planemap::client {
namespace {

using std::chrono::milliseconds;

/// Whether trying again may help.
bool may_heal(const Error& error) {
  return error.kind == Error::Kind::kUnreachable || error.kind == Error::Kind::kIncomplete;
}

}  // namespace

GrpcMapWatch::GrpcMapWatch(std::shared_ptr<GrpcChannel> channel)
    : channel_(std::move(channel)), open_at_(Clock::now()), heard_at_(open_at_), listened_at_(open_at_) {}

Expected<MapChange> GrpcMapWatch::next(milliseconds timeout) {
  const milliseconds silent_after = channel_->options().silent_after;
  const auto begin = Clock::now();
  const auto deadline = begin + timeout;
  // Where nobody has listened for so long, what came in between is still to be read.
  if (begin - listened_at_ >= silent_after) heard_at_ = begin;
  for (;;) {
    const auto until = std::min(deadline, heard_at_ + silent_after);
    const auto left = std::max(std::chrono::ceil<milliseconds>(deadline - Clock::now()), milliseconds(1));
    auto news = wait_for_news(until, mirror_.has_map() ? std::max(left, channel_->options().catch_up_for) : left);
    listened_at_ = Clock::now();
    if (!news) return tl::make_unexpected(news.error());
    if (*news && !(*news)->empty()) return std::move(**news);
    if (listened_at_ - heard_at_ >= silent_after) {
      open_again_later();
      heard_at_ = listened_at_;  // the next call may wait as long again
      return tl::make_unexpected(silence(silent_after));
    }
    if (listened_at_ < deadline) continue;
    if (mirror_.has_map()) return mirror_.no_change();
    return tl::make_unexpected(silence(timeout));
  }
}

/// Takes one step: connects, takes an event, or takes the snapshot that is needed.
GrpcMapWatch::News GrpcMapWatch::wait_for_news(Clock::time_point until, milliseconds snapshot_timeout) {
  if (needs_snapshot_) return take_snapshot(snapshot_timeout);
  if (!stream_) {
    if (Clock::now() < open_at_) {
      std::this_thread::sleep_until(std::min(until, open_at_));
      return std::nullopt;
    }
    const Map& map = mirror_.map();
    stream_ = std::make_unique<WatchStream>(*channel_, MapVersion{map.epoch, map.revision});
    coming_.reset();
  }
  const auto came = stream_->next(until);
  if (const auto* status = std::get_if<grpc::Status>(&came)) return take_end(*status);
  if (const auto* event = std::get_if<const v1::WatchEvent*>(&came)) {
    heard_at_ = Clock::now();
    cut_off_.clear();
    return take(**event, snapshot_timeout);
  }
  return std::nullopt;
}

GrpcMapWatch::News GrpcMapWatch::take(const v1::WatchEvent& event, milliseconds snapshot_timeout) {
  if (event.has_delta()) return take_delta(event);
  if (!event.has_snapshot_needed()) return std::nullopt;
  coming_.reset();
  needs_snapshot_ = true;
  return take_snapshot(snapshot_timeout);
}

GrpcMapWatch::News GrpcMapWatch::take_delta(const v1::WatchEvent& event) {
  const v1::Delta& page = event.delta();
  if (page.page() == 0) {
    coming_.emplace();
    pages_ = 0;
  }
  MapVersion version;
  const bool is_next = coming_ && page.page() == pages_ && read(event.map(), version) &&
                       read_all(page.changed(), coming_->planes) && read_all(page.removed(), coming_->removed);
  if (!is_next) {
    open_again_later();
    return malformed("a delta");
  }
  ++pages_;
  if (!page.last()) return std::nullopt;
  Delta delta = std::move(*coming_);
  coming_.reset();
  delta.epoch = version.epoch;
  delta.revision = version.revision;
  delta.since_revision = static_cast<std::int64_t>(page.since_revision());
  delta.frame = mirror_.map().frame;
  if (mirror_.fits(delta)) return mirror_.apply(std::move(delta));
  const bool is_known = version.epoch == mirror_.map().epoch && version.revision <= mirror_.map().revision;
  needs_snapshot_ = !is_known;  // it begins behind what the mirror has
  return std::nullopt;
}

GrpcMapWatch::News GrpcMapWatch::take_snapshot(milliseconds timeout) {
  auto map = read_snapshot(*channel_, timeout);
  if (!map && !may_heal(map.error())) return tl::make_unexpected(map.error());
  if (!map) {
    cut_off_ = map.error().message;
    open_again_later();
    return std::nullopt;
  }
  heard_at_ = Clock::now();
  cut_off_.clear();
  needs_snapshot_ = false;
  return mirror_.replace(std::move(*map));
}

GrpcMapWatch::News GrpcMapWatch::take_end(const grpc::Status& status) {
  open_again_later();
  const Error error = status.ok() ? Error{Error::Kind::kUnreachable, channel_->server() + " ended the watch"}
                                  : channel_->error_of(status, milliseconds(0));
  cut_off_ = error.message;
  if (!may_heal(error)) return tl::make_unexpected(error);
  return std::nullopt;
}

/// The stream then asks for a snapshot itself, if one is needed.
void GrpcMapWatch::open_again_later() {
  stream_ = nullptr;  // first: it is of the channel
  channel_ = channel_->connect_again();
  coming_.reset();
  needs_snapshot_ = false;
  open_at_ = Clock::now() + channel_->options().connect_after;
}

Error GrpcMapWatch::silence(milliseconds time) const {
  if (!cut_off_.empty()) return {Error::Kind::kUnreachable, cut_off_};
  return {Error::Kind::kUnreachable,
          "nothing was heard of a planemap service at " + channel_->server() + " for " + seconds_text(time)};
}

}  // namespace planemap::client

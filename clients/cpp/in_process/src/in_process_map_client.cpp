#include "planemap/client/in_process_map_client.hpp"

#include <algorithm>
#include <planemap_lcm/reply_t.hpp>
#include <planemap_lcm/request_t.hpp>
#include <thread>
#include <utility>

#include "lcm/query_answers.hpp"
#include "map_mirror.hpp"
#include "serve/lcm/map_answers.hpp"

namespace planemap::client {
namespace {

using planemap_lcm::reply_t;
using planemap_lcm::request_t;
using std::chrono::milliseconds;

tl::unexpected<Error> refused(std::string message) {
  return tl::make_unexpected(Error{Error::Kind::kRefused, std::move(message)});
}

/// Mirrors the map by looking at it.
class InProcessMapWatch final : public MapWatch {
 public:
  using Look = std::function<std::shared_ptr<const SnapshotQueries>()>;

  InProcessMapWatch(Look look, MapClient& client, milliseconds look_after)
      : look_(std::move(look)), client_(client), look_after_(look_after) {}

  Expected<MapChange> next(milliseconds timeout) override;
  const Map& map() const override { return mirror_.map(); }

 private:
  bool has_news() const;

  Look look_;
  MapClient& client_;
  milliseconds look_after_;
  MapMirror mirror_;
};

bool InProcessMapWatch::has_news() const {
  if (!mirror_.has_map()) return true;
  const MapSnapshot& snapshot = look_()->snapshot();
  return static_cast<std::int64_t>(snapshot.epoch()) != mirror_.map().epoch ||
         static_cast<std::int64_t>(snapshot.revision()) != mirror_.map().revision;
}

Expected<MapChange> InProcessMapWatch::next(milliseconds timeout) {
  const auto deadline = std::chrono::steady_clock::now() + timeout;
  for (;;) {
    if (has_news()) {
      auto map = client_.snapshot(timeout);
      if (!map) return tl::make_unexpected(map.error());
      MapChange change = mirror_.replace(std::move(*map));
      change.caught_up = change.new_map;  // nothing was lost
      if (!change.empty()) return change;
    }
    const auto now = std::chrono::steady_clock::now();
    if (now >= deadline) return mirror_.no_change();
    std::this_thread::sleep_until(std::min(deadline, now + look_after_));
  }
}

}  // namespace

/// Answers requests from the map, one page each.
class InProcessMapClient::Source {
 public:
  explicit Source(MapSource source) : source_(std::move(source)) {}

  Expected<Replies> answer(const request_t& arguments);
  std::shared_ptr<const SnapshotQueries> queries() const { return source_.queries(); }
  Status status() const { return source_.status(); }

 private:
  std::shared_ptr<const SnapshotQueries> queries_for(const request_t& request);

  MapSource source_;
  std::shared_ptr<const SnapshotQueries> last_;  ///< that answered: for questions that come in parts
};

std::shared_ptr<const SnapshotQueries> InProcessMapClient::Source::queries_for(const request_t& request) {
  if (request.epoch == 0) return source_.queries();
  const bool is_meant = last_ != nullptr && static_cast<std::int64_t>(last_->snapshot().epoch()) == request.epoch &&
                        static_cast<std::int64_t>(last_->snapshot().revision()) == request.revision;
  return is_meant ? last_ : nullptr;
}

Expected<Replies> InProcessMapClient::Source::answer(const request_t& arguments) {
  service::Request request;
  request.operation = arguments.operation;
  request.arguments = arguments;
  if (auto refusal = service::check_arguments(request)) return refused(std::move(refusal->message));
  const auto queries = queries_for(arguments);
  if (queries == nullptr) {
    return tl::make_unexpected(Error{Error::Kind::kGone, "that revision of the map is not kept any more"});
  }
  last_ = queries;
  reply_t reply{};
  reply.epoch = static_cast<std::int64_t>(queries->snapshot().epoch());
  reply.revision = static_cast<std::int64_t>(queries->snapshot().revision());
  reply.frame = source_.frame;
  if (auto refusal = service::answer_from(*queries, request, reply)) return refused(std::move(refusal->message));
  Replies pages;
  pages.push_back(std::move(reply));
  return pages;
}

InProcessMapClient::InProcessMapClient(MapSource source, const InProcessOptions& options)
    : source_(std::make_unique<Source>(std::move(source))), options_(options) {}

InProcessMapClient::~InProcessMapClient() = default;

Expected<Status> InProcessMapClient::status(Timeout /*timeout*/) {
  return source_->status();
}

Expected<Replies> InProcessMapClient::ask(const request_t& request, Timeout /*timeout*/) {
  return source_->answer(request);
}

std::unique_ptr<MapWatch> InProcessMapClient::watch() {
  return std::make_unique<InProcessMapWatch>([this] { return source_->queries(); }, *this, options_.look_after);
}

}  // namespace planemap::client

#include "planemap/client/lcm_map_client.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <lcm/lcm-cpp.hpp>
#include <planemap_lcm/request_t.hpp>
#include <random>
#include <utility>

#include "page_collector.hpp"
#include "reply_codec.hpp"

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
constexpr const char* kReceiveBuffer = "recv_buf_size=4194304";

std::uint64_t random_number() {
  std::random_device random;
  return (static_cast<std::uint64_t>(random()) << 32u) | random();
}

std::string random_reply_channel() {
  char name[32];
  std::snprintf(name, sizeof name, "PLANEMAP_REPLY_%016llx", static_cast<unsigned long long>(random_number()));
  return name;
}

std::string with_receive_buffer(const std::string& url) {
  if (url.rfind("udpm://", 0) != 0 || url.find("recv_buf_size") != std::string::npos) return url;
  return url + (url.find('?') == std::string::npos ? '?' : '&') + kReceiveBuffer;
}

/// What is asked for.
struct Question {
  std::int16_t operation = 0;
  std::int64_t epoch = 0;  ///< 0: the newest map
  std::int64_t revision = 0;
};

tl::unexpected<Error> no_network(std::string message) {
  return tl::make_unexpected(Error{Error::Kind::kNoNetwork, std::move(message)});
}

std::string seconds_text(milliseconds time) {
  char text[32];
  std::snprintf(text, sizeof text, "%g s", static_cast<double>(time.count()) / 1000.0);
  return text;
}

}  // namespace

std::string default_lcm_url() {
  const char* url = std::getenv("LCM_DEFAULT_URL");
  return url != nullptr && *url != '\0' ? url : "udpm://239.255.76.67:7667?ttl=0";
}

class LcmMapClient::Impl {
 public:
  Impl(std::shared_ptr<lcm::LCM> bus, const LcmClientOptions& options)
      : bus_(std::move(bus)),
        options_(options),
        reply_channel_(random_reply_channel()),
        next_id_(static_cast<std::int64_t>(random_number() >> 2u)),
        collector_(0) {
    subscription_ = bus_->subscribe(reply_channel_, &Impl::on_reply, this);
    if (subscription_ != nullptr) subscription_->setQueueCapacity(kQueuedMessages);
  }
  ~Impl() {
    if (subscription_ != nullptr) bus_->unsubscribe(subscription_);
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  Expected<std::vector<reply_t>> ask(const Question& question, milliseconds timeout);
  Expected<Map> whole_map(milliseconds timeout);
  std::size_t malformed_count() const { return malformed_; }

 private:
  void on_reply(const lcm::ReceiveBuffer* buffer, const std::string& channel) noexcept;
  bool send(const Question& question, std::int32_t page);
  bool begin(const Question& question);
  bool ask_again(const Question& question);
  tl::unexpected<Error> gave_up(milliseconds timeout) const;

  std::shared_ptr<lcm::LCM> bus_;
  LcmClientOptions options_;
  std::string reply_channel_;
  lcm::Subscription* subscription_ = nullptr;
  std::int64_t next_id_;
  PageCollector collector_;
  bool refused_ = false;       ///< the service answered the present request with an error
  bool contradicted_ = false;  ///< pages of the present request do not fit each other
  std::size_t malformed_ = 0;
  std::string last_malformed_;
};

void LcmMapClient::Impl::on_reply(const lcm::ReceiveBuffer* buffer, const std::string& /*channel*/) noexcept {
  try {
    auto reply = decode_reply({static_cast<const std::uint8_t*>(buffer->data), buffer->data_size});
    if (!reply) {
      ++malformed_;
      last_malformed_ = reply.error();
      return;
    }
    const PageCollector::Outcome outcome = collector_.add(std::move(*reply));
    refused_ = refused_ || outcome == PageCollector::Outcome::kError;
    contradicted_ = contradicted_ || outcome == PageCollector::Outcome::kContradiction;
  } catch (...) {  // C code is on the stack; only memory can have run out
    ++malformed_;
  }
}

bool LcmMapClient::Impl::send(const Question& question, std::int32_t page) {
  request_t request{};
  request.utime =
      std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::system_clock::now().time_since_epoch())
          .count();
  request.request_id = collector_.request_id();
  request.reply_channel = reply_channel_;
  request.operation = question.operation;
  request.epoch = page >= 0 ? collector_.epoch() : question.epoch;
  request.revision = page >= 0 ? collector_.revision() : question.revision;
  request.page = page;
  return bus_->publish(options_.request_channel, &request) == 0;
}

/// Sends the request under a new id, so that pages of earlier tries can't mix with those to come.
bool LcmMapClient::Impl::begin(const Question& question) {
  collector_ = PageCollector(next_id_++);
  refused_ = false;
  contradicted_ = false;
  return send(question, -1);
}

/// Nothing came for a while: the whole request again, or the pages that are missing.
bool LcmMapClient::Impl::ask_again(const Question& question) {
  if (!collector_.any()) return begin(question);
  const auto missing = collector_.missing(kMissingAskedAtOnce);
  return std::all_of(missing.begin(), missing.end(), [&](std::int32_t page) { return send(question, page); });
}

tl::unexpected<Error> LcmMapClient::Impl::gave_up(milliseconds timeout) const {
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

Expected<std::vector<reply_t>> LcmMapClient::Impl::ask(const Question& question, milliseconds timeout) {
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

Expected<Map> LcmMapClient::Impl::whole_map(milliseconds timeout) {
  const Clock::time_point deadline = Clock::now() + timeout;
  const auto time_left = [&] {
    return std::max(milliseconds(0), std::chrono::duration_cast<milliseconds>(deadline - Clock::now()));
  };
  const auto incomplete = [&](const char* what) {
    return tl::make_unexpected(Error{Error::Kind::kIncomplete, what + (" within " + seconds_text(timeout))});
  };
  do {
    auto map = ask({request_t::OPERATION_SNAPSHOT}, time_left()).map(map_of);
    if (!map) return map;
    auto cells = ask({request_t::OPERATION_CELLS, map->epoch, map->revision}, time_left()).map(map_of);
    if (!cells && cells.error().kind == Error::Kind::kUnreachable) return incomplete("the planes came, but no cells");
    if (!cells && cells.error().kind != Error::Kind::kGone) return cells;
    if (cells && cells->epoch == map->epoch && cells->revision == map->revision) {
      map->cells = std::move(cells->cells);
      return map;
    }
  } while (time_left() > milliseconds(0));
  return incomplete(
      "the map changed faster than its planes and cells could be asked for; there were no two of one revision");
}

Expected<std::unique_ptr<LcmMapClient>> LcmMapClient::connect(const std::string& url, const LcmClientOptions& options) {
  auto bus = std::make_shared<lcm::LCM>(with_receive_buffer(url));
  if (!bus->good()) {
    return no_network("LCM can't be opened at " + url +
                      "; check the URL and that there is a route for multicast (ip route add 224.0.0.0/4 dev lo)");
  }
  return std::make_unique<LcmMapClient>(std::move(bus), options);
}

LcmMapClient::LcmMapClient(std::shared_ptr<lcm::LCM> bus, const LcmClientOptions& options)
    : impl_(std::make_unique<Impl>(std::move(bus), options)) {}

LcmMapClient::~LcmMapClient() = default;

Expected<Status> LcmMapClient::status(milliseconds timeout) {
  const auto pages = impl_->ask({request_t::OPERATION_STATUS}, timeout);
  if (!pages) return tl::make_unexpected(pages.error());
  for (const reply_t& page : *pages) {
    if (page.n_status == 1) return status_of(page.service_status.front());
  }
  return tl::make_unexpected(Error{Error::Kind::kMalformed, "the service's answer holds no status"});
}

Expected<Map> LcmMapClient::snapshot(milliseconds timeout) {
  return impl_->ask({request_t::OPERATION_SNAPSHOT}, timeout).map(map_of);
}

Expected<Map> LcmMapClient::cells(milliseconds timeout) {
  return impl_->ask({request_t::OPERATION_CELLS}, timeout).map(map_of);
}

Expected<Map> LcmMapClient::whole_map(milliseconds timeout) {
  return impl_->whole_map(timeout);
}

std::size_t LcmMapClient::malformed_count() const {
  return impl_->malformed_count();
}

}  // namespace planemap::client

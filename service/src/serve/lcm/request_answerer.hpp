#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <planemap/snapshot.hpp>
#include <planemap_lcm/status_t.hpp>
#include <string>
#include <vector>

#include "codec/page_codec.hpp"
#include "codec/request_codec.hpp"
#include "serve/lcm/map_answers.hpp"
#include "serve/plane_book.hpp"

namespace planemap::service {

/// What goes out in answer to a request: the pages from `begin` to before `end`, stamped for it.
struct Reply {
  std::string channel;
  std::int64_t request_id = 0;
  std::shared_ptr<const Pages> pages;
  std::size_t begin = 0;
  std::size_t end = 0;
  std::string error;        ///< why it is an error reply; empty: it is none
  bool has_failed = false;  ///< the error is the service's own
};

/// Answers requests from a snapshot; keeps the last replies and their snapshots, so that lost pages can be asked for
/// again, and the cells that go with planes. Not thread-safe.
class RequestAnswerer {
 public:
  /// @param max_reply_bytes  greater answers are refused
  RequestAnswerer(const ServiceConfig& config, PlaneBook& book, std::size_t max_reply_bytes = kMaxReplyBytes);

  /// @param snapshot  the newest
  /// @param status    makes the service's status; called only if it is asked for
  /// @param utime     the service's clock
  /// Where it fails itself (an exception), that is the answer: who asks would only ask again.
  Reply answer(const Request& request, const std::shared_ptr<const MapSnapshot>& snapshot,
               const std::function<planemap_lcm::status_t()>& status, std::int64_t utime);

 private:
  Reply checked_answer(const Request& request, const planemap_lcm::reply_t& header,
                       const std::shared_ptr<const MapSnapshot>& snapshot,
                       const std::function<planemap_lcm::status_t()>& status);
  /// A reply is found again by the channel that it went to, so that two clients who asked at different times never get
  /// pages of each other's reply.
  struct Kept {
    std::string channel;
    std::int16_t operation = 0;
    std::vector<std::uint8_t> argument_bytes;
    std::int64_t epoch = 0;
    std::int64_t revision = 0;
    std::shared_ptr<const MapSnapshot> snapshot;
    std::shared_ptr<const Pages> pages;
  };

  Reply status_reply(const Request& request, planemap_lcm::reply_t header,
                     const std::function<planemap_lcm::status_t()>& status) const;
  Reply whole_answer(const Request& request, planemap_lcm::reply_t header,
                     const std::shared_ptr<const MapSnapshot>& newest);
  std::shared_ptr<const MapSnapshot> snapshot_for(const Request& request,
                                                  const std::shared_ptr<const MapSnapshot>& newest) const;
  Reply gone(const Request& request, const planemap_lcm::reply_t& header) const;
  Reply lost_page(const Request& request, const planemap_lcm::reply_t& header) const;
  Reply error(const Request& request, planemap_lcm::reply_t header, Refusal refusal) const;
  tl::expected<std::shared_ptr<const Pages>, Refusal> pages_of(const Request& request, planemap_lcm::reply_t header,
                                                               const std::shared_ptr<const MapSnapshot>& snapshot);
  void keep(const Request& request, const std::shared_ptr<const MapSnapshot>& snapshot,
            std::shared_ptr<const Pages> pages);

  PlaneBook& book_;
  std::string frame_;
  std::size_t page_bytes_;
  std::size_t kept_replies_;
  std::size_t max_reply_bytes_;
  std::deque<Kept> kept_;  ///< the newest in front
};

}  // namespace planemap::service

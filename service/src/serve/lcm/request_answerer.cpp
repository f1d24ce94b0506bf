#include "serve/lcm/request_answerer.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <exception>
#include <planemap_lcm/request_t.hpp>
#include <string>
#include <utility>

namespace planemap::service {
namespace {

using planemap_lcm::reply_t;
using planemap_lcm::request_t;

/// Whether a kept reply is to what is asked now.
template <class Kept>
bool is_same_question(const Kept& kept, const Request& request) {
  return kept.operation == request.operation && kept.argument_bytes == request.argument_bytes;
}

Reply all_pages(const Request& request, std::shared_ptr<const Pages> pages) {
  const std::size_t count = pages->size();
  return Reply{request.reply_channel, request.request_id, std::move(pages), 0, count, {}, false};
}

}  // namespace

RequestAnswerer::RequestAnswerer(const ServiceConfig& config, PlaneBook& book, std::size_t max_reply_bytes)
    : book_(book),
      frame_(config.map.frame),
      page_bytes_(static_cast<std::size_t>(config.publish.page_bytes)),
      kept_replies_(static_cast<std::size_t>(config.publish.kept_replies)),
      max_reply_bytes_(max_reply_bytes) {}

Reply RequestAnswerer::answer(const Request& request, const std::shared_ptr<const MapSnapshot>& snapshot,
                              const std::function<planemap_lcm::status_t()>& status, std::int64_t utime) {
  reply_t header{};
  header.utime = utime;
  header.request_id = request.request_id;
  header.epoch = static_cast<std::int64_t>(snapshot->epoch());
  header.revision = static_cast<std::int64_t>(snapshot->revision());
  header.status = reply_t::STATUS_OK;
  header.frame = frame_;
  try {
    return checked_answer(request, header, snapshot, status);
  } catch (const std::exception& e) {
    auto reply =
        error(request, header, {reply_t::STATUS_FAILED, std::string("the service could not answer: ") + e.what()});
    reply.has_failed = true;
    return reply;
  }
}

Reply RequestAnswerer::checked_answer(const Request& request, const reply_t& header,
                                      const std::shared_ptr<const MapSnapshot>& snapshot,
                                      const std::function<planemap_lcm::status_t()>& status) {
  const bool is_status = request.operation == request_t::OPERATION_STATUS;
  if (!is_status && !is_map_operation(request.operation)) {
    return error(request, header,
                 {reply_t::STATUS_UNKNOWN_OPERATION,
                  fmt::format("operation {} is not known (known: {})", request.operation, known_operations())});
  }
  if (request.page < -1) {
    return error(request, header,
                 {reply_t::STATUS_BAD_REQUEST,
                  fmt::format("page is {} (allowed: -1 for all, or the number of a lost page)", request.page)});
  }
  if (auto refusal = check_arguments(request)) return error(request, header, std::move(*refusal));
  if (is_status) return status_reply(request, header, status);
  return request.page >= 0 ? lost_page(request, header) : whole_answer(request, header, snapshot);
}

Reply RequestAnswerer::status_reply(const Request& request, reply_t header,
                                    const std::function<planemap_lcm::status_t()>& status) const {
  if (request.page > 0) {
    return error(request, header,
                 {reply_t::STATUS_BAD_REQUEST, fmt::format("page {} of 1: a status is one page", request.page)});
  }
  header.service_status.push_back(status());
  auto pages = encode_pages(header, page_bytes_, 0.0);
  header.service_status.clear();
  if (!pages) return error(request, header, {reply_t::STATUS_TOO_LARGE, pages.error().message});
  return all_pages(request, std::make_shared<const Pages>(std::move(*pages)));
}

Reply RequestAnswerer::whole_answer(const Request& request, reply_t header,
                                    const std::shared_ptr<const MapSnapshot>& newest) {
  const auto snapshot = snapshot_for(request, newest);
  if (!snapshot) return gone(request, header);
  header.epoch = static_cast<std::int64_t>(snapshot->epoch());
  header.revision = static_cast<std::int64_t>(snapshot->revision());
  auto pages = pages_of(request, header, snapshot);
  if (!pages) return error(request, header, std::move(pages.error()));
  return all_pages(request, std::move(*pages));
}

/// The newest one, or that of the revision which the request names; nullptr if it is not kept any more. Snapshots of
/// one revision have the same planes, but a later one may have more cells: what went to the asking channel comes first.
std::shared_ptr<const MapSnapshot> RequestAnswerer::snapshot_for(
    const Request& request, const std::shared_ptr<const MapSnapshot>& newest) const {
  if (request.epoch == 0) return newest;
  const auto is_meant = [&](const std::shared_ptr<const MapSnapshot>& snapshot) {
    return static_cast<std::int64_t>(snapshot->epoch()) == request.epoch &&
           static_cast<std::int64_t>(snapshot->revision()) == request.revision;
  };
  const auto own = std::find_if(kept_.begin(), kept_.end(), [&](const Kept& k) {
    return k.channel == request.reply_channel && is_meant(k.snapshot);
  });
  if (own != kept_.end()) return own->snapshot;
  if (is_meant(newest)) return newest;
  const auto other = std::find_if(kept_.begin(), kept_.end(), [&](const Kept& k) { return is_meant(k.snapshot); });
  return other != kept_.end() ? other->snapshot : nullptr;
}

Reply RequestAnswerer::gone(const Request& request, const reply_t& header) const {
  return error(request, header,
               {reply_t::STATUS_GONE, fmt::format("the map of epoch {} revision {} is not kept any more: ask anew",
                                                  request.epoch, request.revision)});
}

Reply RequestAnswerer::lost_page(const Request& request, const reply_t& header) const {
  const auto kept = std::find_if(kept_.begin(), kept_.end(), [&](const Kept& k) {
    return k.channel == request.reply_channel && is_same_question(k, request) && k.epoch == request.epoch &&
           k.revision == request.revision;
  });
  if (kept == kept_.end()) {
    return error(request, header,
                 {reply_t::STATUS_GONE,
                  fmt::format("the reply of epoch {} revision {} on {} is not kept any more: ask for all pages",
                              request.epoch, request.revision, request.reply_channel)});
  }
  const auto page = static_cast<std::size_t>(request.page);
  if (page >= kept->pages->size()) {
    return error(request, header,
                 {reply_t::STATUS_BAD_REQUEST,
                  fmt::format("page {} of {} (they are counted from 0)", page, kept->pages->size())});
  }
  return Reply{request.reply_channel, request.request_id, kept->pages, page, page + 1, {}, false};
}

Reply RequestAnswerer::error(const Request& request, reply_t header, Refusal refusal) const {
  header.status = refusal.status;
  header.error = refusal.message;
  header.page = 0;
  header.page_count = 1;
  auto reply = all_pages(request, std::make_shared<const Pages>(Pages{encode(header)}));
  reply.error = std::move(refusal.message);
  return reply;
}

tl::expected<std::shared_ptr<const Pages>, Refusal> RequestAnswerer::pages_of(
    const Request& request, reply_t header, const std::shared_ptr<const MapSnapshot>& snapshot) {
  const auto same = std::find_if(kept_.begin(), kept_.end(),
                                 [&](const Kept& k) { return is_same_question(k, request) && k.snapshot == snapshot; });
  std::shared_ptr<const Pages> pages;
  if (same != kept_.end()) {
    pages = same->pages;
  } else {
    if (auto refusal = answer_from(*book_.open(snapshot), request, header, max_reply_bytes_)) {
      return tl::make_unexpected(std::move(*refusal));
    }
    auto made = encode_pages(std::move(header), page_bytes_, snapshot->cell_size_m());
    if (!made) return tl::make_unexpected(Refusal{reply_t::STATUS_TOO_LARGE, made.error().message});
    if (made->size() * page_bytes_ > max_reply_bytes_) {
      return tl::make_unexpected(
          Refusal{reply_t::STATUS_TOO_LARGE,
                  fmt::format("the answer is {} pages of {} bytes, more than {} bytes in all; ask for less at a time",
                              made->size(), page_bytes_, max_reply_bytes_)});
    }
    pages = std::make_shared<const Pages>(std::move(*made));
  }
  keep(request, snapshot, pages);
  return pages;
}

void RequestAnswerer::keep(const Request& request, const std::shared_ptr<const MapSnapshot>& snapshot,
                           std::shared_ptr<const Pages> pages) {
  // An older reply to the same question on the same channel would only be mixed up with this one.
  const auto old = std::find_if(kept_.begin(), kept_.end(), [&](const Kept& k) {
    return k.channel == request.reply_channel && k.operation == request.operation;
  });
  if (old != kept_.end()) kept_.erase(old);
  kept_.push_front(Kept{request.reply_channel, request.operation, request.argument_bytes,
                        static_cast<std::int64_t>(snapshot->epoch()), static_cast<std::int64_t>(snapshot->revision()),
                        snapshot, std::move(pages)});
  if (kept_.size() > kept_replies_) kept_.pop_back();
}

}  // namespace planemap::service

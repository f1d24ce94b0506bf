#include "serve/lcm/request_answerer.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <planemap_lcm/request_t.hpp>
#include <utility>
#include <vector>

#include "codec/plane_codec.hpp"

namespace planemap::service {
namespace {

using planemap_lcm::reply_t;
using planemap_lcm::request_t;

/// More than this is not sent over a datagram bus: some five million cells.
constexpr std::size_t kMaxReplyBytes = std::size_t{256} << 20;

bool is_map_operation(std::int16_t operation) {
  return operation == request_t::OPERATION_SNAPSHOT || operation == request_t::OPERATION_CELLS;
}

Reply all_pages(const Request& request, std::shared_ptr<const Pages> pages) {
  const std::size_t count = pages->size();
  return Reply{request.reply_channel, request.request_id, std::move(pages), 0, count, {}};
}

}  // namespace

RequestAnswerer::RequestAnswerer(const ServiceConfig& config, PlaneBook& book)
    : book_(book),
      frame_(config.map.frame),
      page_bytes_(static_cast<std::size_t>(config.publish.page_bytes)),
      kept_replies_(static_cast<std::size_t>(config.publish.kept_replies)) {}

Reply RequestAnswerer::answer(const Request& request, const std::shared_ptr<const MapSnapshot>& snapshot,
                              const std::function<planemap_lcm::status_t()>& status, std::int64_t utime) {
  reply_t header{};
  header.utime = utime;
  header.request_id = request.request_id;
  header.epoch = static_cast<std::int64_t>(snapshot->epoch());
  header.revision = static_cast<std::int64_t>(snapshot->revision());
  header.status = reply_t::STATUS_OK;
  header.frame = frame_;
  if (request.operation != request_t::OPERATION_STATUS && !is_map_operation(request.operation)) {
    return error(request, header, reply_t::STATUS_UNKNOWN_OPERATION,
                 fmt::format("operation {} is not known (known: {} status, {} snapshot, {} cells)", request.operation,
                             request_t::OPERATION_STATUS, request_t::OPERATION_SNAPSHOT, request_t::OPERATION_CELLS));
  }
  if (request.page < -1) {
    return error(request, header, reply_t::STATUS_BAD_REQUEST,
                 fmt::format("page is {} (allowed: -1 for all, or the number of a lost page)", request.page));
  }
  if (request.operation == request_t::OPERATION_STATUS) {
    if (request.page > 0) {
      return error(request, header, reply_t::STATUS_BAD_REQUEST,
                   fmt::format("page {} of 1: a status is one page", request.page));
    }
    header.service_status.push_back(status());
    return all_pages(request, std::make_shared<const Pages>(encode_pages(header, {}, {}, page_bytes_, 0.0)));
  }
  return request.page >= 0 ? lost_page(request, header) : whole_answer(request, std::move(header), snapshot);
}

Reply RequestAnswerer::whole_answer(const Request& request, reply_t header,
                                    const std::shared_ptr<const MapSnapshot>& newest) {
  const auto snapshot = snapshot_for(request, newest);
  if (!snapshot) return gone(request, header);
  header.epoch = static_cast<std::int64_t>(snapshot->epoch());
  header.revision = static_cast<std::int64_t>(snapshot->revision());
  auto pages = pages_of(request, header, snapshot);
  if (!pages) {
    return error(request, header, reply_t::STATUS_TOO_LARGE,
                 fmt::format("the map's {} cells are more than {} MiB", snapshot->cell_count(), kMaxReplyBytes >> 20));
  }
  return all_pages(request, std::move(pages));
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
  return error(
      request, header, reply_t::STATUS_GONE,
      fmt::format("the map of epoch {} revision {} is not kept any more: ask anew", request.epoch, request.revision));
}

Reply RequestAnswerer::lost_page(const Request& request, const reply_t& header) const {
  const auto kept = std::find_if(kept_.begin(), kept_.end(), [&](const Kept& k) {
    return k.channel == request.reply_channel && k.operation == request.operation && k.epoch == request.epoch &&
           k.revision == request.revision;
  });
  if (kept == kept_.end()) {
    return error(request, header, reply_t::STATUS_GONE,
                 fmt::format("the reply of epoch {} revision {} on {} is not kept any more: ask for all pages",
                             request.epoch, request.revision, request.reply_channel));
  }
  const auto page = static_cast<std::size_t>(request.page);
  if (page >= kept->pages->size()) {
    return error(request, header, reply_t::STATUS_BAD_REQUEST,
                 fmt::format("page {} of {} (they are counted from 0)", page, kept->pages->size()));
  }
  return Reply{request.reply_channel, request.request_id, kept->pages, page, page + 1, {}};
}

Reply RequestAnswerer::error(const Request& request, reply_t header, std::int8_t code, std::string message) const {
  header.status = code;
  header.error = message;
  auto reply =
      all_pages(request, std::make_shared<const Pages>(encode_pages(std::move(header), {}, {}, page_bytes_, 0.0)));
  reply.error = std::move(message);
  return reply;
}

std::shared_ptr<const Pages> RequestAnswerer::pages_of(const Request& request, const reply_t& header,
                                                       const std::shared_ptr<const MapSnapshot>& snapshot) {
  const auto same = std::find_if(kept_.begin(), kept_.end(), [&](const Kept& k) {
    return k.operation == request.operation && k.snapshot == snapshot;
  });
  std::shared_ptr<const Pages> pages;
  if (same != kept_.end()) {
    pages = same->pages;
  } else {
    std::vector<planemap_lcm::plane_t> planes;
    std::vector<planemap_lcm::cell_t> cells;
    if (request.operation == request_t::OPERATION_SNAPSHOT) {
      for (const auto& plane : book_.describe(snapshot)) {
        planes.push_back(to_wire(*plane.record, *plane.outline, plane.plane_class));
      }
    } else {
      if (snapshot->cell_count() > kMaxReplyBytes / sizeof(planemap_lcm::cell_t)) return nullptr;
      snapshot->for_each_cell([&](const CellView& cell) { cells.push_back(to_wire(cell)); });
    }
    pages = std::make_shared<const Pages>(
        encode_pages(header, std::move(planes), cells, page_bytes_, snapshot->cell_size_m()));
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
  kept_.push_front(Kept{request.reply_channel, request.operation, static_cast<std::int64_t>(snapshot->epoch()),
                        static_cast<std::int64_t>(snapshot->revision()), snapshot, std::move(pages)});
  if (kept_.size() > kept_replies_) kept_.pop_back();
}

}  // namespace planemap::service

#include "codec/page_codec.hpp"

#include <algorithm>
#include <drake/lcmt_point_cloud.hpp>
#include <planemap_lcm/status_t.hpp>
#include <stdexcept>
#include <utility>

#include "codec/plane_codec.hpp"

namespace planemap::service {
namespace {

using planemap_lcm::plane_t;
using planemap_lcm::planes_t;
using planemap_lcm::reply_t;

/// Fills messages one after the other, opening a new one when the next item has no room.
template <class Message>
class Pager {
 public:
  Pager(Message empty, std::size_t page_bytes)
      : empty_(std::move(empty)), page_bytes_(page_bytes), pages_{empty_}, used_bytes_(size_of(empty_)) {}

  /// Room for an item in a page of its own.
  std::size_t greatest_item() const { return page_bytes_ - std::min(page_bytes_, size_of(empty_)); }

  /// @return false: it is too large for a page of its own, and left out
  template <class Item>
  bool add(std::vector<Item> Message::*list, Item item) {
    const auto bytes = static_cast<std::size_t>(item._getEncodedSizeNoHash());
    if (bytes > greatest_item()) return false;
    if (used_bytes_ + bytes > page_bytes_) {
      pages_.push_back(empty_);
      used_bytes_ = size_of(empty_);
    }
    used_bytes_ += bytes;
    (pages_.back().*list).push_back(std::move(item));
    return true;
  }

  std::vector<Message> take() {
    for (std::size_t i = 0; i < pages_.size(); ++i) {
      pages_[i].page = static_cast<std::int32_t>(i);
      pages_[i].page_count = static_cast<std::int32_t>(pages_.size());
    }
    return std::move(pages_);
  }

 private:
  static std::size_t size_of(const Message& message) { return static_cast<std::size_t>(message.getEncodedSize()); }

  Message empty_;
  std::size_t page_bytes_;
  std::vector<Message> pages_;
  std::size_t used_bytes_;
};

/// Takes the lists out of an answer, and puts their items on pages.
class ReplyPager {
 public:
  ReplyPager(reply_t answer, std::size_t page_bytes, double cell_size_m)
      : answer_(std::move(answer)), cell_size_m_(cell_size_m), pager_(head_of(answer_), page_bytes) {}

  Expected<Pages> pages() {
    add(&reply_t::service_status, "the status");
    add(&reply_t::lookups, "the plane's lineage and links");
    add(&reply_t::floorplans, "the floor plan");
    add_simplified(&reply_t::planes, "a plane");
    add(&reply_t::cells, "a cell");
    add(&reply_t::near_planes, "a near plane");
    add(&reply_t::plane_hits, "a hit");
    add(&reply_t::cell_hits, "a hit");
    add_simplified(&reply_t::region_planes, "a plane of the region");
    add_simplified(&reply_t::plan_polygons, "a polygon of the floor plan");
    if (too_large_ != nullptr) {
      return fail(std::string(too_large_) + " does not fit on a page (publish.page_bytes)");
    }
    Pages pages;
    for (auto& message : pager_.take()) {
      set_counts(message);
      pages.push_back(encode(message));
    }
    return pages;
  }

 private:
  /// The same without what the lists hold.
  static reply_t head_of(const reply_t& answer) {
    reply_t head{};
    head.utime = answer.utime;
    head.request_id = answer.request_id;
    head.epoch = answer.epoch;
    head.revision = answer.revision;
    head.status = answer.status;
    head.error = answer.error;
    head.frame = answer.frame;
    return head;
  }
  static void set_counts(reply_t& page) {
    const auto size = [](const auto& list) { return static_cast<std::int32_t>(list.size()); };
    page.n_planes = size(page.planes);
    page.n_cells = size(page.cells);
    page.n_status = size(page.service_status);
    page.n_near_planes = size(page.near_planes);
    page.n_plane_hits = size(page.plane_hits);
    page.n_cell_hits = size(page.cell_hits);
    page.n_region_planes = size(page.region_planes);
    page.n_lookups = size(page.lookups);
    page.n_floorplans = size(page.floorplans);
    page.n_plan_polygons = size(page.plan_polygons);
  }

  template <class Item>
  void add(std::vector<Item> reply_t::*list, const char* what) {
    for (Item& item : answer_.*list) {
      if (!pager_.add(list, std::move(item))) too_large_ = what;
    }
  }
  template <class Item>
  void add_simplified(std::vector<Item> reply_t::*list, const char* what) {
    for (Item& item : answer_.*list) simplify_to_fit(item, pager_.greatest_item(), cell_size_m_);
    add(list, what);
  }

  reply_t answer_;
  double cell_size_m_;
  Pager<reply_t> pager_;
  const char* too_large_ = nullptr;
};

void put_big_endian(std::int64_t value, std::uint8_t* out) {
  for (int i = 7; i >= 0; --i, value >>= 8) out[i] = static_cast<std::uint8_t>(value & 0xff);
}

}  // namespace

template <class Message>
Page encode(const Message& message) {
  Page page(static_cast<std::size_t>(message.getEncodedSize()));
  const int size = static_cast<int>(page.size());
  if (message.encode(page.data(), 0, size) != size)
    throw std::runtime_error("encode: the message does not fit its own size");
  return page;
}
template Page encode(const planemap_lcm::status_t&);
template Page encode(const planes_t&);
template Page encode(const reply_t&);
template Page encode(const drake::lcmt_point_cloud&);

Pages encode_pages(planes_t header, std::vector<plane_t> planes,
                   const std::vector<planemap_lcm::removed_plane_t>& removed, std::size_t page_bytes,
                   double cell_size_m) {
  header.n_planes = header.n_removed = 0;
  Pager<planes_t> pager(header, page_bytes);
  for (auto& plane : planes) {
    simplify_to_fit(plane, pager.greatest_item(), cell_size_m);
    pager.add(&planes_t::planes, std::move(plane));
  }
  for (const auto& plane : removed) pager.add(&planes_t::removed, plane);
  Pages pages;
  for (auto& message : pager.take()) {
    message.n_planes = static_cast<std::int32_t>(message.planes.size());
    message.n_removed = static_cast<std::int32_t>(message.removed.size());
    pages.push_back(encode(message));
  }
  return pages;
}

Expected<Pages> encode_pages(reply_t answer, std::size_t page_bytes, double cell_size_m) {
  return ReplyPager(std::move(answer), page_bytes, cell_size_m).pages();
}

void restamp_reply(Page& page, std::int64_t utime, std::int64_t request_id) {
  // reply_t begins with its fingerprint, utime and request_id, 8 bytes each.
  put_big_endian(utime, page.data() + 8);
  put_big_endian(request_id, page.data() + 16);
}

}  // namespace planemap::service

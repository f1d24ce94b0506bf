#include "codec/page_codec.hpp"

#include <algorithm>
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
  Pager(const Message& first, Message others, std::size_t page_bytes)
      : empty_(std::move(others)), page_bytes_(page_bytes), pages_{first}, used_bytes_(size_of(first)) {}

  /// Room for an item in a page of its own.
  std::size_t greatest_item() const { return page_bytes_ - std::min(page_bytes_, size_of(empty_)); }

  template <class Item>
  void add(std::vector<Item> Message::*list, Item item) {
    const auto bytes = static_cast<std::size_t>(item._getEncodedSizeNoHash());
    if (used_bytes_ + bytes > page_bytes_) {
      pages_.push_back(empty_);
      used_bytes_ = size_of(empty_);
    }
    used_bytes_ += bytes;
    (pages_.back().*list).push_back(std::move(item));
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

template <class Message>
void add_planes(Pager<Message>& pager, std::vector<plane_t> planes, double cell_size_m) {
  for (auto& plane : planes) {
    simplify_to_fit(plane, pager.greatest_item(), cell_size_m);
    pager.add(&Message::planes, std::move(plane));
  }
}

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

Pages encode_pages(planes_t header, std::vector<plane_t> planes,
                   const std::vector<planemap_lcm::removed_plane_t>& removed, std::size_t page_bytes,
                   double cell_size_m) {
  header.n_planes = header.n_removed = 0;
  Pager<planes_t> pager(header, header, page_bytes);
  add_planes(pager, std::move(planes), cell_size_m);
  for (const auto& plane : removed) pager.add(&planes_t::removed, plane);
  Pages pages;
  for (auto& message : pager.take()) {
    message.n_planes = static_cast<std::int32_t>(message.planes.size());
    message.n_removed = static_cast<std::int32_t>(message.removed.size());
    pages.push_back(encode(message));
  }
  return pages;
}

Pages encode_pages(reply_t header, std::vector<plane_t> planes, const std::vector<planemap_lcm::cell_t>& cells,
                   std::size_t page_bytes, double cell_size_m) {
  header.n_planes = header.n_cells = 0;
  header.n_status = static_cast<std::int32_t>(header.service_status.size());
  reply_t others = header;
  others.n_status = 0;
  others.service_status.clear();
  Pager<reply_t> pager(header, std::move(others), page_bytes);
  add_planes(pager, std::move(planes), cell_size_m);
  for (const auto& cell : cells) pager.add(&reply_t::cells, cell);
  Pages pages;
  for (auto& message : pager.take()) {
    message.n_planes = static_cast<std::int32_t>(message.planes.size());
    message.n_cells = static_cast<std::int32_t>(message.cells.size());
    pages.push_back(encode(message));
  }
  return pages;
}

void restamp_reply(Page& page, std::int64_t utime, std::int64_t request_id) {
  // reply_t begins with its fingerprint, utime and request_id, 8 bytes each.
  put_big_endian(utime, page.data() + 8);
  put_big_endian(request_id, page.data() + 16);
}

}  // namespace planemap::service

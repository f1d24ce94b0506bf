#include "lcm/page_collector.hpp"

#include <algorithm>
#include <utility>

namespace planemap::client {

PageCollector::Outcome PageCollector::add(planemap_lcm::reply_t page) {
  if (page.request_id != request_id_) return Outcome::kNotOurs;
  if (page.status != planemap_lcm::reply_t::STATUS_OK) {
    error_ = std::move(page);
    return Outcome::kError;
  }
  if (!any()) {
    epoch_ = page.epoch;
    revision_ = page.revision;
    have_.assign(static_cast<std::size_t>(page.page_count), false);
  }
  if (page.epoch != epoch_ || page.revision != revision_ || static_cast<std::size_t>(page.page_count) != have_.size()) {
    return Outcome::kContradiction;
  }
  const auto number = static_cast<std::size_t>(page.page);
  if (have_[number]) return Outcome::kDuplicate;
  have_[number] = true;
  ++received_;
  pages_.push_back(std::move(page));
  return Outcome::kTaken;
}

std::vector<std::int32_t> PageCollector::missing(std::size_t at_most) const {
  std::vector<std::int32_t> numbers;
  for (std::size_t i = 0; i < have_.size() && numbers.size() < at_most; ++i) {
    if (!have_[i]) numbers.push_back(static_cast<std::int32_t>(i));
  }
  return numbers;
}

std::vector<planemap_lcm::reply_t> PageCollector::take() {
  std::sort(pages_.begin(), pages_.end(), [](const auto& a, const auto& b) { return a.page < b.page; });
  return std::move(pages_);
}

}  // namespace planemap::client

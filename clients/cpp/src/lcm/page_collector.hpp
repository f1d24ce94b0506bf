#pragma once

#include <cstdint>
#include <planemap_lcm/reply_t.hpp>
#include <vector>

namespace planemap::client {

/// Gathers the pages of the answer to one request, in whatever order and number they come.
class PageCollector {
 public:
  enum class Outcome {
    kTaken,
    kNotOurs,        ///< an answer to another request
    kDuplicate,      ///< that page is there already
    kContradiction,  ///< other epoch, revision or page count than the pages before
    kError,          ///< the service's answer is an error; see error()
  };

  explicit PageCollector(std::int64_t request_id) : request_id_(request_id) {}

  Outcome add(planemap_lcm::reply_t page);

  bool any() const { return received_ > 0; }
  bool complete() const { return any() && received_ == have_.size(); }
  /// Numbers of the pages that have not come, at most so many, ascending. Only once any() is true.
  std::vector<std::int32_t> missing(std::size_t at_most) const;
  std::size_t page_count() const { return have_.size(); }
  std::size_t received() const { return received_; }
  std::int64_t request_id() const { return request_id_; }
  std::int64_t epoch() const { return epoch_; }
  std::int64_t revision() const { return revision_; }
  const planemap_lcm::reply_t& error() const { return error_; }

  /// All pages, by number. @pre complete()
  std::vector<planemap_lcm::reply_t> take();

 private:
  std::int64_t request_id_;
  std::int64_t epoch_ = 0;
  std::int64_t revision_ = 0;
  std::size_t received_ = 0;
  std::vector<bool> have_;
  std::vector<planemap_lcm::reply_t> pages_;  ///< in the order in which they came: memory for pages that did come
  planemap_lcm::reply_t error_;
};

}  // namespace planemap::client

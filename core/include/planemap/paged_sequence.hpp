#pragma once

#include <array>
#include <cstddef>
#include <iterator>
#include <memory>
#include <planemap/pool.hpp>
#include <utility>
#include <vector>

namespace planemap {

/// A sequence that grows at its end, and is shared with readers page by page: that costs a pointer for every 64
/// elements, and the first change of a page after that a copy of the page. Many threads may read what was shared while
/// one changes the original. What was moved from is good for nothing but being destroyed.
template <class T>
class PagedSequence {
 public:
  static constexpr std::size_t kPageSize = 64;

  PagedSequence() = default;
  PagedSequence(PagedSequence&&) noexcept = default;
  PagedSequence& operator=(PagedSequence&&) noexcept = default;
  PagedSequence(const PagedSequence&) = delete;  // who of the two would own the pages?
  PagedSequence& operator=(const PagedSequence&) = delete;
  ~PagedSequence() = default;

  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  const T& operator[](std::size_t i) const { return pages_[i / kPageSize]->items[i % kPageSize]; }
  /// Whether a page, elements 64 k to 64 k + 63, is the very same one in another sequence.
  bool shares_page(std::size_t page, const PagedSequence& other) const {
    return page < pages_.size() && page < other.pages_.size() && pages_[page] == other.pages_[page];
  }

  void push_back(T item) {
    if (size_ % kPageSize == 0) {
      pages_.push_back(pool_.take());
      is_own_.push_back(true);
    }
    set(size_++, std::move(item));
  }
  /// @pre i < size()
  void set(std::size_t i, T item) {
    const std::size_t at = i / kPageSize;
    if (!is_own_[at]) {
      auto page = pool_.take();
      page->items = pages_[at]->items;
      pages_[at] = std::move(page);
      is_own_[at] = true;
    }
    pages_[at]->items[i % kPageSize] = std::move(item);
  }
  /// Makes another sequence the same as this one is now. Takes the memory that the other has.
  void share(PagedSequence& other) {
    other.pages_ = pages_;
    other.is_own_.assign(pages_.size(), false);
    other.size_ = size_;
    is_own_.assign(pages_.size(), false);
  }
  void clear() {
    pages_.clear();
    is_own_.clear();
    size_ = 0;
  }

  class Iterator {
   public:
    using iterator_category = std::random_access_iterator_tag;
    using value_type = T;
    using difference_type = std::ptrdiff_t;
    using pointer = const T*;
    using reference = const T&;

    Iterator() = default;
    Iterator(const PagedSequence* sequence, std::size_t at) : sequence_(sequence), at_(at) {}
    reference operator*() const { return (*sequence_)[at_]; }
    pointer operator->() const { return &(*sequence_)[at_]; }
    reference operator[](difference_type n) const { return *(*this + n); }
    Iterator& operator++() { return *this += 1; }
    Iterator& operator--() { return *this += -1; }
    Iterator operator++(int) { return std::exchange(*this, *this + 1); }
    Iterator operator--(int) { return std::exchange(*this, *this + -1); }
    Iterator& operator+=(difference_type n) {
      at_ = static_cast<std::size_t>(static_cast<difference_type>(at_) + n);
      return *this;
    }
    Iterator& operator-=(difference_type n) { return *this += -n; }
    Iterator operator+(difference_type n) const { return Iterator(*this) += n; }
    friend Iterator operator+(difference_type n, const Iterator& it) { return it + n; }
    Iterator operator-(difference_type n) const { return Iterator(*this) += -n; }
    difference_type operator-(const Iterator& other) const {
      return static_cast<difference_type>(at_) - static_cast<difference_type>(other.at_);
    }
    auto operator<=>(const Iterator& other) const { return at_ <=> other.at_; }
    bool operator==(const Iterator& other) const { return at_ == other.at_; }

   private:
    const PagedSequence* sequence_ = nullptr;
    std::size_t at_ = 0;
  };
  Iterator begin() const { return {this, 0}; }
  Iterator end() const { return {this, size_}; }

 private:
  struct Page {
    std::array<T, kPageSize> items{};
    void forget() { items.fill(T{}); }
  };

  std::vector<std::shared_ptr<Page>> pages_;
  std::vector<bool> is_own_;  ///< by page: nobody else has it
  std::size_t size_ = 0;
  Pool<Page> pool_;
};

}  // namespace planemap

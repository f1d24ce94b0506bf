#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace planemap {

/// Objects that are used over and over again: one that nobody holds any more waits, with the memory that it has, for
/// the next who needs one. Where T has a member forget(), it is called when the last pointer is dropped: by whoever
/// drops it, on any thread. Objects may outlive their pool.
template <class T>
class Pool {
 public:
  Pool() : shelf_(std::make_shared<Shelf>()) {}

  /// One that waits, as its last holder left it, else what make() returns: a std::unique_ptr<T>.
  template <class Make>
  std::shared_ptr<T> take(Make&& make) {
    std::unique_ptr<T> object = shelf_->take_object();
    if (!object) object = make();
    return std::shared_ptr<T>(object.release(), Return{shelf_}, Allocator<T>{shelf_});
  }
  std::shared_ptr<T> take() {
    return take([] { return std::make_unique<T>(); });
  }
  /// Objects that wait.
  std::size_t waiting() const { return shelf_->waiting(); }
  /// Frees half of the objects that have waited ever since the last call: who held more of them for a while, such as a
  /// slow reader, does not hold their memory for ever.
  void trim() { shelf_->trim(); }

 private:
  /// What goes with a pointer: its count, how it is returned, and who has the memory for that.
  static constexpr std::size_t kControlBytes = 96;
  using Control = std::array<std::max_align_t, kControlBytes / sizeof(std::max_align_t)>;

  class Shelf {
   public:
    std::unique_ptr<T> take_object() {
      const std::lock_guard lock(mutex_);
      if (objects_.empty()) return nullptr;
      auto object = std::move(objects_.back());
      objects_.pop_back();
      fewest_ = std::min(fewest_, objects_.size());
      return object;
    }
    void put(std::unique_ptr<T> object) {
      const std::lock_guard lock(mutex_);
      objects_.push_back(std::move(object));
    }
    std::unique_ptr<Control> take_control() {
      {
        const std::lock_guard lock(mutex_);
        if (!controls_.empty()) {
          auto control = std::move(controls_.back());
          controls_.pop_back();
          return control;
        }
      }
      return std::make_unique<Control>();
    }
    void put(std::unique_ptr<Control> control) {
      const std::lock_guard lock(mutex_);
      controls_.push_back(std::move(control));
    }
    std::size_t waiting() const {
      const std::lock_guard lock(mutex_);
      return objects_.size();
    }
    void trim() {
      std::vector<std::unique_ptr<T>> surplus;
      const std::lock_guard lock(mutex_);
      for (std::size_t n = (fewest_ + 1) / 2; n > 0; --n) {
        surplus.push_back(std::move(objects_.back()));
        objects_.pop_back();
      }
      fewest_ = objects_.size();
    }

   private:
    mutable std::mutex mutex_;
    std::vector<std::unique_ptr<T>> objects_;
    std::size_t fewest_ = 0;  ///< objects that waited at once, since trim()
    std::vector<std::unique_ptr<Control>> controls_;
  };

  struct Return {
    std::shared_ptr<Shelf> shelf;
    void operator()(T* object) const {
      std::unique_ptr<T> owned(object);
      if constexpr (requires { owned->forget(); }) owned->forget();
      shelf->put(std::move(owned));
    }
  };

  template <class U>
  struct Allocator {
    using value_type = U;
    std::shared_ptr<Shelf> shelf;

    explicit Allocator(std::shared_ptr<Shelf> from) : shelf(std::move(from)) {}
    template <class V>
    Allocator(const Allocator<V>& other) : shelf(other.shelf) {}  // NOLINT(google-explicit-constructor)
    U* allocate(std::size_t) {
      static_assert(sizeof(U) <= kControlBytes);
      static_assert(alignof(U) <= alignof(std::max_align_t));
      return reinterpret_cast<U*>(shelf->take_control().release());
    }
    void deallocate(U* control, std::size_t) {
      shelf->put(std::unique_ptr<Control>(reinterpret_cast<Control*>(control)));
    }
    template <class V>
    bool operator==(const Allocator<V>& other) const {
      return shelf == other.shelf;
    }
  };

  std::shared_ptr<Shelf> shelf_;
};

}  // namespace planemap

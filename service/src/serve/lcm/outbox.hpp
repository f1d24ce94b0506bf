#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <string>

#include "codec/page_codec.hpp"
#include "serve/lcm/request_answerer.hpp"

namespace planemap::service {

/// Pages on their way out, one at a time with a pause after each, so that no receiver's buffer is run over. Not
/// thread-safe.
class Outbox {
 public:
  explicit Outbox(double page_pause_s) : page_pause_s_(page_pause_s) {}

  struct Message {
    std::string channel;
    Page bytes;
  };

  void add(Reply reply);
  void add(const std::string& channel, Pages pages);
  bool empty() const { return jobs_.empty(); }
  std::size_t jobs() const { return jobs_.size(); }
  /// When the next page may go; meaningless if empty.
  double due_s() const { return due_s_; }
  /// Takes the next page. @pre !empty()
  Message take(double now_s, std::int64_t utime);

 private:
  struct Job {
    Reply reply;
    bool is_reply = false;
  };

  double page_pause_s_;
  double due_s_ = 0.0;
  std::deque<Job> jobs_;
};

}  // namespace planemap::service

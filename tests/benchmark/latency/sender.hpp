#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <lcm/lcm-cpp.hpp>
#include <planemap/sources/frame_source.hpp>
#include <planemap_lcm/depth_scan_t.hpp>
#include <stop_token>
#include <thread>
#include <vector>

#include "latency/latency_run.hpp"

namespace planemap::benchmark {

/// Sends frames, forth and back, as scans at one rate and poses at another, from a thread of its own. Poses lie at
/// times of their own, between those of the scans: each scan has to wait for the pose that comes after it.
class Sender {
 public:
  /// Makes the messages ready. @throws std::invalid_argument if there are fewer than two frames
  Sender(const LatencyConfig& config, const std::vector<sources::Frame>& frames);
  void start();
  bool is_done() const { return is_done_; }
  std::size_t sent() const { return sent_; }
  std::size_t late() const { return late_; }

 private:
  void run(const std::stop_token& stop);
  void send_scan(std::size_t i, std::int64_t utime);
  void send_pose(double after_s, std::int64_t utime);
  std::size_t frame_of(std::size_t i) const;

  lcm::LCM lcm_;
  std::size_t scans_;
  double period_s_;
  double pose_period_s_;
  std::vector<planemap_lcm::depth_scan_t> messages_;
  std::vector<Eigen::Isometry3d> T_world_sensor_;
  std::vector<std::uint8_t> bytes_;  ///< of the scan that is being sent
  std::atomic<std::size_t> sent_ = 0;
  std::atomic<std::size_t> late_ = 0;
  std::atomic<bool> is_done_ = false;
  std::jthread thread_;  ///< last: it ends before what it uses
};

}  // namespace planemap::benchmark

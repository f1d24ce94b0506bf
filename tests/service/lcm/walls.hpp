#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <planemap/mapper.hpp>
#include <utility>
#include <vector>

#include "codec/page_codec.hpp"

namespace planemap::service {

/// The messages of pages, each of which must be a whole one.
template <class Message>
std::vector<Message> decoded(const Pages& pages) {
  std::vector<Message> messages;
  for (const auto& page : pages) {
    Message message{};
    const int size = static_cast<int>(page.size());
    EXPECT_EQ(message.decode(page.data(), 0, size), size);
    messages.push_back(std::move(message));
  }
  return messages;
}

/// A mapper that looks at walls; snapshots come from it.
class Walls {
 public:
  explicit Walls(std::uint64_t epoch = 9) : mapper_(preset(Preset::kBest), epoch) {}
  void look_at(std::uint16_t depth_mm, double yaw_rad = 0.0) {
    DepthScan scan;
    scan.utime = ++utime_;
    scan.intrinsics = {80, 60, 75.0, 75.0, 40.0, 30.0};
    scan.depth.assign(80 * 60, depth_mm);
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.linear() = Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitY()).toRotationMatrix();
    mapper_.integrate(scan, T);
  }
  std::shared_ptr<const MapSnapshot> snapshot() { return mapper_.snapshot(); }

 private:
  Mapper mapper_;
  std::int64_t utime_ = 1000000;
};

}  // namespace planemap::service

#pragma once

#include <Eigen/Geometry>
#include <chrono>
#include <cstdint>
#include <lcm/lcm-cpp.hpp>
#include <memory>
#include <string>

#include "service.hpp"
#include "support/messages.hpp"

namespace planemap {

/// A real service on a bus of its own, and a small camera that looks at surfaces 1 m away, 1.07 m by 0.8 m each. World:
/// z up, floor at z = 0. Whoever waits for something handles the bus.
class RoomService {
 public:
  static service::ServiceConfig default_config() {
    service::ServiceConfig config;
    config.map.gravity = {0.0, 0.0, -1.0};
    config.publish.status_period_s = 0.05;
    config.publish.delta_period_s = 0.01;
    config.publish.page_bytes = 4096;
    config.queue.scans = 1000;
    return config;
  }

  explicit RoomService(const service::ServiceConfig& config = default_config(), std::uint64_t epoch = 1234,
                       const std::string& url = "memq://")
      : config_(config), bus_(std::make_shared<lcm::LCM>(url)), service_(config, *bus_, epoch) {}

  const service::ServiceConfig& config() const { return config_; }

  const std::shared_ptr<lcm::LCM>& bus() { return bus_; }
  service::Service& service() { return service_; }

  /// Looks along `forward` from a place, and waits until what is seen there is in the map.
  /// @param down  which way the picture's y goes; unit, square on forward
  void look(const Eigen::Vector3d& from_m, const Eigen::Vector3d& forward,
            const Eigen::Vector3d& down = -Eigen::Vector3d::UnitZ()) {
    send_look(from_m, forward, down);
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (service_.counters().at("scans.mapped") < looks_) {
      if (std::chrono::steady_clock::now() > deadline) throw std::runtime_error("RoomService: a scan was not mapped");
      service_.handle(5);
    }
  }
  /// The same without waiting: the scan and its pose are on the bus, not yet handled.
  void send_look(const Eigen::Vector3d& from_m, const Eigen::Vector3d& forward,
                 const Eigen::Vector3d& down = -Eigen::Vector3d::UnitZ()) {
    ++looks_;
    const std::int64_t utime = 10'000'000 + 1'000'000 * looks_;
    Eigen::Matrix3d R;
    R << down.cross(forward), down, forward;
    const Eigen::Quaterniond q(R);
    bot_core::pose_t pose = pose_message(utime);
    for (Eigen::Index i = 0; i < 3; ++i) pose.pos[i] = from_m[i];
    pose.orientation[0] = q.w();
    pose.orientation[1] = q.x();
    pose.orientation[2] = q.y();
    pose.orientation[3] = q.z();
    send("POSE", encoded(pose));
    send("PLANEMAP_SCAN", encoded(zipped(wall_message(utime, static_cast<std::int32_t>(looks_)))));
  }
  /// The floor about the origin, from 1 m above.
  void look_at_floor() { look({0.0, 0.0, 1.0}, -Eigen::Vector3d::UnitZ(), -Eigen::Vector3d::UnitX()); }
  /// The wall x = 1 about a y.
  void look_at_wall(double y_m) { look({0.0, y_m, 1.0}, Eigen::Vector3d::UnitX()); }
  /// Floor, and two pieces of the wall that are too far from each other to be one plane.
  void look_around() {
    look_at_floor();
    look_at_wall(-1.1);
    look_at_wall(1.1);
  }
  /// What is between the pieces: they become one plane.
  void join_walls() { look_at_wall(0.0); }

 private:
  void send(const std::string& channel, const Bytes& bytes) {
    if (bus_->publish(channel, bytes.data(), static_cast<unsigned>(bytes.size())) != 0) {
      throw std::runtime_error("RoomService: nothing can be sent");
    }
  }

  const service::ServiceConfig config_;
  std::shared_ptr<lcm::LCM> bus_;
  service::Service service_;
  std::int64_t looks_ = 0;
};

}  // namespace planemap

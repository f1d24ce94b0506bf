#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <numeric>

#include "config/config_reader.hpp"
#include "config/listen_address.hpp"

namespace planemap::service {
namespace {

/// Quaternions that were written with three digits are taken and normalised; others are slips.
constexpr double kUnitTolerance = 1e-3;

double norm_of(const std::vector<double>& v) {
  return std::sqrt(std::inner_product(v.begin(), v.end(), v.begin(), 0.0));
}

void scale_to_unit(std::vector<double>& v) {
  const double norm = norm_of(v);
  // Reading back what was printed must change nothing, so a vector that is as good as unit stays as it is.
  if (std::abs(norm - 1.0) <= 1e-12) return;
  for (double& x : v) x /= norm;
}

void check_less(const std::string& path, const char* low_key, double low, const char* high_key, double high,
                ConfigProblems& problems) {
  if (low < high) return;
  problems.add(path + "." + low_key, fmt::format("{} must be less than {} ({})", low, high_key, high));
}

void check_channel_name(const std::string& key, const std::string& name, ConfigProblems& problems) {
  const bool plain = std::all_of(name.begin(), name.end(), [](unsigned char c) { return std::isgraph(c) != 0; });
  if (!plain) problems.add(key, "a channel's name must be printable ASCII without spaces");
}

/// Families whose messages say nothing of the camera.
bool needs_intrinsics(ScanFamily family) {
  return family == ScanFamily::kKinectFrame || family == ScanFamily::kImages || family == ScanFamily::kImage ||
         family == ScanFamily::kImageArray;
}

void check_camera(const std::string& path, const InputConfig& input, ConfigProblems& problems) {
  const auto& k = input.intrinsics;
  const auto is_whole = [](double pixels) { return pixels >= 1.0 && pixels <= 4096.0 && std::floor(pixels) == pixels; };
  if (k.empty()) {
    if (needs_intrinsics(input.family)) {
      problems.add(path + ".intrinsics", "are missing: the family's messages bring none; [fx, fy, cx, cy] in pixels");
    }
  } else if (k.size() != 4 && k.size() != 6) {
    problems.add(path + ".intrinsics",
                 fmt::format("has {} numbers, must have 4 (fx, fy, cx, cy) or 6 (width and height, too)", k.size()));
  } else if (k[0] <= 0.0 || k[1] <= 0.0) {
    problems.add(path + ".intrinsics", fmt::format("fx {} and fy {} must be above 0", k[0], k[1]));
  } else if (k.size() == 6 && (!is_whole(k[4]) || !is_whole(k[5]))) {
    problems.add(path + ".intrinsics",
                 fmt::format("width {} and height {} must be whole numbers of 1 to 4096 pixels", k[4], k[5]));
  }
  const auto& d = input.disparity;
  if (d.size() == 1)
    problems.add(path + ".disparity", "has 1 number, must have 2 (baseline in metres, offset) or none");
  if (d.size() == 2 && (d[0] <= 0.0 || d[0] > 1.0 || d[1] <= 0.0 || d[1] > 10000.0)) {
    problems.add(
        path + ".disparity",
        fmt::format("baseline {} must be above 0 and at most 1 m, offset {} above 0 and at most 10000", d[0], d[1]));
  }
}

void check_input(const std::string& path, InputConfig& input, ConfigProblems& problems) {
  check_channel_name(path + ".channel", input.channel, problems);
  check_channel_name(path + ".pose_channel", input.pose_channel, problems);
  check_camera(path, input, problems);
  check_less(path, "min_range_m", input.min_range_m, "max_range_m", input.max_range_m, problems);
  const double norm = norm_of(input.rotation_wxyz);
  if (std::abs(norm - 1.0) > kUnitTolerance) {
    problems.add(
        path + ".rotation_wxyz",
        fmt::format("is no unit quaternion: its length is {:.6g} (allowed: 1 within {})", norm, kUnitTolerance));
  } else {
    scale_to_unit(input.rotation_wxyz);
  }
  for (std::size_t i = 0; i < input.body_mask.size(); ++i) {
    const auto& box = input.body_mask[i];
    const std::string box_path = fmt::format("{}.body_mask.{}", path, i);
    if (box.min_m.size() != 3 || box.max_m.size() != 3) {
      problems.add(box_path, "needs min_m and max_m, three numbers each");
      continue;
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (box.min_m[axis] < box.max_m[axis]) continue;
      problems.add(box_path, fmt::format("min_m must be less than max_m along {}", "xyz"[axis]));
    }
  }
}

/// Each channel has one use, but for poses, which several inputs may share.
void check_channel_uses(const ServiceConfig& config, ConfigProblems& problems) {
  std::map<std::string, std::string> users;
  const auto claim = [&](const std::string& key, const std::string& channel, bool shared) {
    const auto [entry, is_new] = users.emplace(channel, key);
    const bool both_poses = shared && entry->second.find(".pose_channel") != std::string::npos;
    if (!is_new && !both_poses) problems.add(key, fmt::format("'{}' is used by {}, too", channel, entry->second));
  };
  for (std::size_t i = 0; i < config.inputs.size(); ++i) {
    claim(fmt::format("inputs.{}.channel", i), config.inputs[i].channel, false);
  }
  for (std::size_t i = 0; i < config.inputs.size(); ++i) {
    claim(fmt::format("inputs.{}.pose_channel", i), config.inputs[i].pose_channel, true);
  }
  claim("publish.status_channel", config.publish.status_channel, false);
  claim("publish.delta_channel", config.publish.delta_channel, false);
  claim("publish.request_channel", config.publish.request_channel, false);
  if (!config.publish.point_cloud_channel.empty()) {
    claim("publish.point_cloud_channel", config.publish.point_cloud_channel, false);
  }
}

void check_names(const std::vector<InputConfig>& inputs, ConfigProblems& problems) {
  for (std::size_t i = 1; i < inputs.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (inputs[i].name != inputs[j].name) continue;
      problems.add(fmt::format("inputs.{}.name", i),
                   fmt::format("'{}' is the name of inputs.{}, too", inputs[i].name, j));
    }
  }
}

void check_gravity(MapConfig& map, ConfigProblems& problems) {
  if (map.gravity.empty()) return;
  if (map.gravity.size() != 3) {
    problems.add("map.gravity", fmt::format("has {} numbers, must have 3, or none", map.gravity.size()));
  } else if (norm_of(map.gravity) < 1e-6) {
    problems.add("map.gravity", "is zero; leave it empty where the direction is not known");
  } else {
    scale_to_unit(map.gravity);
  }
}

void check_grpc(const GrpcConfig& grpc, ConfigProblems& problems) {
  if (grpc.tls_certificate.empty() != grpc.tls_key.empty()) {
    problems.add(grpc.tls_key.empty() ? "grpc.tls_key" : "grpc.tls_certificate",
                 "is missing: certificate and key go together");
  }
  if (!grpc.tls_client_ca.empty() && grpc.tls_certificate.empty()) {
    problems.add("grpc.tls_client_ca", "needs grpc.tls_certificate and grpc.tls_key: without TLS nobody shows one");
  }
  if (grpc.listen.empty()) return;
  const auto address = parse_listen_address(grpc.listen);
  if (!address) {
    problems.add("grpc.listen", address.error().message);
  } else if (!address->is_loopback() && grpc.tls_certificate.empty()) {
    problems.add("grpc.listen", fmt::format("{} can be reached from other machines: it needs grpc.tls_certificate and "
                                            "grpc.tls_key (or listen on 127.0.0.1)",
                                            grpc.listen));
  }
}

void check_http(const HttpConfig& http, ConfigProblems& problems) {
  if (http.max_event_streams >= http.max_connections) {
    problems.add("http.max_event_streams",
                 fmt::format("{} must be less than max_connections ({}): requests need some, too",
                             http.max_event_streams, http.max_connections));
  }
  if (http.listen.empty()) return;
  const auto address = parse_listen_address(http.listen);
  if (!address) {
    problems.add("http.listen", address.error().message);
  } else if (!address->is_loopback() && !http.allow_remote) {
    problems.add("http.listen", fmt::format("{} can be reached from other machines, and there it is plain text that "
                                            "anybody may read; http.allow_remote: true allows it (or listen on "
                                            "127.0.0.1)",
                                            http.listen));
  }
}

}  // namespace

void check_config(ServiceConfig& config, ConfigProblems& problems) {
  if (!is_supported(config.mapper.core.simd)) {
    problems.add("core.simd", "this machine does not have that instruction set; auto takes the best that it has");
  }
  check_less("sensor", "min_range_m", config.mapper.sensor.min_range_m, "max_range_m", config.mapper.sensor.max_range_m,
             problems);
  check_gravity(config.map, problems);
  for (std::size_t i = 0; i < config.inputs.size(); ++i) {
    check_input(fmt::format("inputs.{}", i), config.inputs[i], problems);
  }
  check_names(config.inputs, problems);
  check_channel_uses(config, problems);
  if (config.pose.exact_s > config.pose.max_gap_s) {
    problems.add("pose.exact_s",
                 fmt::format("{} must be at most max_gap_s ({})", config.pose.exact_s, config.pose.max_gap_s));
  }
  if (config.pose.buffer_s < config.pose.max_gap_s + config.pose.max_wait_s) {
    problems.add("pose.buffer_s", fmt::format("{} must be at least max_gap_s + max_wait_s ({})", config.pose.buffer_s,
                                              config.pose.max_gap_s + config.pose.max_wait_s));
  }
  if (config.pose.restart_s > config.pose.buffer_s) {
    problems.add("pose.restart_s",
                 fmt::format("{} must be at most buffer_s ({})", config.pose.restart_s, config.pose.buffer_s));
  }
  check_channel_name("publish.status_channel", config.publish.status_channel, problems);
  check_channel_name("publish.delta_channel", config.publish.delta_channel, problems);
  check_channel_name("publish.request_channel", config.publish.request_channel, problems);
  check_channel_name("publish.point_cloud_channel", config.publish.point_cloud_channel, problems);
  check_grpc(config.grpc, problems);
  check_http(config.http, problems);
}

}  // namespace planemap::service

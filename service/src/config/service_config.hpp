#pragma once

#include <cstdint>
#include <planemap/config.hpp>
#include <planemap/expected.hpp>
#include <planemap/scan.hpp>
#include <string>
#include <vector>

namespace planemap::service {

// Settings of the service, one struct a module; each is listed in its visit_fields(), as those of core are.

/// Names and directions of the map.
struct MapConfig {
  std::string frame = "world";
  std::vector<double> gravity;  ///< points down in the world frame; empty: not known
};

struct LcmConfig {
  std::string url = "udpm://239.255.76.67:7667?ttl=0";
  int recv_buf_bytes = 2097152;  ///< added to udpm URLs as recv_buf_size; compared with net.core.rmem_max at start
};

/// A box fixed to the body, metres in the body frame; points inside are the robot's own.
struct MaskBox {
  std::vector<double> min_m;  ///< x y z
  std::vector<double> max_m;  ///< x y z
};

/// One sensor.
struct InputConfig {
  std::string name = "kinect";
  std::string channel = "PLANEMAP_SCAN";
  std::string pose_channel = "POSE";
  std::vector<double> translation_m = {0.0, 0.0, 0.0};       ///< T_body_sensor: origin of the sensor in the body frame
  std::vector<double> rotation_wxyz = {1.0, 0.0, 0.0, 0.0};  ///< T_body_sensor: unit quaternion, sensor to body
  double min_range_m = 0.0;                                  ///< beside those of the section sensor
  double max_range_m = 1000.0;
  double max_rate_hz = 0.0;  ///< scans beyond this rate are dropped and counted; 0: no limit
  std::vector<MaskBox> body_mask;
};

/// How poses are found for scans.
struct PoseConfig {
  double buffer_s = 10.0;    ///< history that is kept
  double max_gap_s = 0.5;    ///< poses farther apart are not interpolated between
  double max_wait_s = 0.5;   ///< a scan waits so long for the pose after it
  double exact_s = 0.001;    ///< a pose this near to the scan's utime needs no other
  double jump_m = 1.0;       ///< a step between two poses above this is a jump: counted and said
  double jump_deg = 45.0;
};

struct QueueConfig {
  int scans = 4;  ///< bound; the oldest is dropped
};

struct PublishConfig {
  std::string status_channel = "PLANEMAP_STATUS";
  std::string delta_channel = "PLANEMAP_DELTA";
  std::string request_channel = "PLANEMAP_REQUEST";
  double status_period_s = 1.0;
  double delta_period_s = 0.2;    ///< least time between two deltas
  int page_bytes = 60000;
  double page_pause_s = 0.0005;   ///< between the pages of a reply, so that receivers keep up
  int kept_replies = 8;           ///< replies kept for lost pages
};

struct LogConfig {
  std::string level = "info";   ///< trace, debug, info, warn, error
  std::string format = "text";  ///< text or json
};

struct LimitsConfig {
  int image_bytes = 67108864;  ///< greatest scan after decompression
};

struct ServiceConfig {
  MapperConfig mapper;  ///< sections sensor, grid, normals and planes
  MapConfig map;
  LcmConfig lcm;
  std::vector<InputConfig> inputs = {InputConfig{}};
  PoseConfig pose;
  QueueConfig queue;
  PublishConfig publish;
  LogConfig log;
  LimitsConfig limits;
};

/// Where the settings come from; later ones win: preset, file, overrides.
struct ConfigSources {
  std::string preset = "best";         ///< best or paper; --preset
  std::string file;                    ///< YAML; empty: none; --config
  std::vector<std::string> overrides;  ///< "section.key=value", the value in YAML; --set
};

/// Reads, overrides and checks. The error lists every problem, one a line, with file, line and key.
Expected<ServiceConfig> load_config(const ConfigSources& sources);

/// The configuration as YAML with a comment for each key; load_config reads it back to the same.
std::string to_yaml(const ServiceConfig& config);

}  // namespace planemap::service

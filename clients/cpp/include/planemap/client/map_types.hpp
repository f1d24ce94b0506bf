#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <tl/expected.hpp>
#include <vector>

/// What a planemap service tells its clients, in plain types of the standard library. Metres, radians, square metres;
/// world frame; utimes in microseconds.
namespace planemap::client {

using Vector3 = std::array<double, 3>;

/// A ring in its plane's basis, (u, v) in metres, without its first point again at the end.
using Ring = std::vector<std::array<double, 2>>;

struct Polygon {
  Ring outer;               ///< counter-clockwise seen from the normal's side
  std::vector<Ring> holes;  ///< clockwise
};

/// One plane: normal . x + d = 0, |normal| = 1, the normal towards the side from which it was seen.
struct Plane {
  std::int64_t id = 0;  ///< never used again
  Vector3 normal{};
  double d = 0.0;
  std::array<double, 16> covariance{};  ///< of (nx, ny, nz, d), row-major
  Vector3 centroid_m{};
  double area_m2 = 0.0;
  std::int64_t cell_count = 0;
  std::int64_t point_count = 0;
  std::int64_t first_seen_utime = 0;
  std::int64_t last_seen_utime = 0;
  std::string plane_class;  ///< floor, ceiling, wall, table, slope or other
  double quality = 0.0;     ///< 0 to 1
  std::int64_t revision = 0;
  Vector3 origin_m{};  ///< a point (u, v) of the polygons is origin_m + u * axis_u + v * axis_v
  Vector3 axis_u{};
  Vector3 axis_v{};
  std::vector<Polygon> polygons;
};

/// One dense cell.
struct Cell {
  Vector3 centre_m{};
  Vector3 sigma_m{};           ///< standard errors of the centre
  Vector3 normal{};            ///< unit; zero where it is unknown
  double deviation_rad = 0.0;  ///< of the normal
  std::int64_t count = 0;      ///< points
  std::int64_t plane_id = 0;   ///< 0: none
};

/// A map at one revision; holds planes, cells or both, whichever was asked for.
struct Map {
  std::string frame;
  std::int64_t epoch = 0;
  std::int64_t revision = 0;
  std::vector<Plane> planes;  ///< by id
  std::vector<Cell> cells;
};

/// How the service is.
struct Status {
  std::int64_t utime = 0;
  std::string version;
  std::int64_t epoch = 0;
  std::int64_t revision = 0;
  std::int64_t plane_count = 0;
  std::int64_t cell_count = 0;
  std::int64_t block_count = 0;
  double scan_rate_hz = 0.0;  ///< scans mapped in the last second
  double scan_ms_p50 = 0.0;   ///< milliseconds to map a scan
  double scan_ms_max = 0.0;
  std::int64_t last_scan_utime = 0;  ///< 0: none was mapped yet
  std::string idle_reason;           ///< why nothing is being mapped; empty while scans are mapped
  std::string degraded;              ///< what the service cannot do at present; empty: nothing
  std::map<std::string, std::int64_t> counters;
};

/// Why a request got no answer that can be used.
struct Error {
  enum class Kind {
    kNoNetwork,    ///< LCM can't be opened, or can't send; an address or option of gRPC that can't be used
    kUnreachable,  ///< nobody answered
    kIncomplete,   ///< the service answered, but pages were still missing when time was up
    kRefused,      ///< the service answered with an error
    kDenied,       ///< who asks may not: a token is missing, unknown, or of too small a scope
    kMalformed,    ///< the answer contradicts itself
    kGone,         ///< the service does not keep the revision any more; the client's calls start over then
  };
  Kind kind = Kind::kUnreachable;
  std::string message;  ///< a sentence for the person who asked
};

template <class T>
using Expected = tl::expected<T, Error>;

}  // namespace planemap::client

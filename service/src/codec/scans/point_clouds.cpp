// bot_core.pointcloud2_t and drake.lcmt_point_cloud: points in bytes that fields describe.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <drake/lcmt_point_cloud.hpp>
#include <limits>
#include <string_view>
#include <vector>

#include "codec/scans/families.hpp"

namespace planemap::service {
namespace {

constexpr std::size_t kLeastFieldBytes = 4 + 1 + 4 + 1 + 4;
constexpr std::size_t kMaxKeptFields = 4;
constexpr std::int8_t kFloat32 = 7;
constexpr std::int8_t kFloat64 = 8;

struct CloudField {
  std::string_view name;
  std::int32_t offset = 0;  ///< bytes from the begin of a point
  std::int8_t datatype = 0;
  std::int32_t count = 0;
};

/// A cloud as a message describes it; nothing is checked yet.
struct WireCloud {
  const char* type = "";
  std::int64_t utime = 0;
  std::int32_t seq = -1;
  std::string_view frame;
  std::int64_t width = 0;
  std::int64_t height = 0;
  std::vector<CloudField> fields;
  bool is_big_endian = false;
  std::int64_t point_step = 0;  ///< bytes from a point to the next
  std::int64_t row_step = 0;    ///< bytes from a row to the next
  std::span<const std::uint8_t> data;
};

std::vector<CloudField> read_fields(WireReader& reader) {
  std::vector<CloudField> fields;
  const std::size_t count = reader.count(kLeastFieldBytes);
  fields.reserve(kMaxKeptFields);
  for (std::size_t i = 0; i < count && reader.ok(); ++i) {
    CloudField field;
    field.name = reader.text();
    field.offset = reader.i32();
    field.datatype = reader.i8();
    field.count = reader.i32();
    // Nothing else is kept, and of these no more than show that one is there twice: fields take no memory.
    const bool is_coordinate = field.name == "x" || field.name == "y" || field.name == "z";
    if (is_coordinate && fields.size() < kMaxKeptFields) fields.push_back(field);
  }
  return fields;
}

/// One coordinate: where it stands in a point, and how.
struct Coordinate {
  std::size_t offset = 0;
  bool is_double = false;
};
using Coordinates = std::array<Coordinate, 3>;

Decoded<Coordinates> coordinates_of(const WireCloud& cloud) {
  Coordinates found;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::string_view name = std::string_view("xyz").substr(axis, 1);
    const auto named = [&](const CloudField& field) { return field.name == name; };
    const auto field = std::find_if(cloud.fields.begin(), cloud.fields.end(), named);
    if (field == cloud.fields.end() || std::count_if(field, cloud.fields.end(), named) > 1) {
      return reject("format", fmt::format("{}: needs one field named {}", cloud.type, name));
    }
    if ((field->datatype != kFloat32 && field->datatype != kFloat64) || field->count != 1) {
      return reject("format", fmt::format("{}: field {} has datatype {} and count {} (allowed: 7 float32 or 8 float64, "
                                          "and 1)",
                                          cloud.type, name, field->datatype, field->count));
    }
    const std::int64_t bytes = field->datatype == kFloat32 ? 4 : 8;
    if (field->offset < 0 || field->offset + bytes > cloud.point_step) {
      return reject("size", fmt::format("{}: field {} at byte {} is not within point_step, {} bytes", cloud.type, name,
                                        field->offset, cloud.point_step));
    }
    found[axis] = {static_cast<std::size_t>(field->offset), field->datatype == kFloat64};
  }
  return found;
}

/// Checks the steps against each other and the bytes. @return points
Decoded<std::size_t> check_layout(const WireCloud& cloud, std::size_t max_bytes) {
  constexpr std::int64_t kMost = std::numeric_limits<std::int32_t>::max();
  const auto is_count = [](std::int64_t value) { return value >= 0 && value <= kMost; };
  if (!is_count(cloud.width) || !is_count(cloud.height) || !is_count(cloud.row_step) || cloud.point_step < 1 ||
      !is_count(cloud.point_step)) {
    return reject("size", fmt::format("{}: {} x {} points, point_step {}, row_step {} (allowed: 0 to {} each, "
                                      "point_step from 1)",
                                      cloud.type, cloud.width, cloud.height, cloud.point_step, cloud.row_step, kMost));
  }
  const std::int64_t points = cloud.width * cloud.height;  // below 2^62
  if (points > static_cast<std::int64_t>(max_bytes / 12)) {
    return reject("too_large", fmt::format("{}: {} x {} points are {} bytes, limits.image_bytes is {}", cloud.type,
                                           cloud.width, cloud.height, 12.0 * static_cast<double>(points), max_bytes));
  }
  if (cloud.height > 1 && cloud.row_step < cloud.width * cloud.point_step) {
    return reject("size", fmt::format("{}: row_step is {} for {} points of {} bytes", cloud.type, cloud.row_step,
                                      cloud.width, cloud.point_step));
  }
  const std::int64_t last_row = points > 0 ? cloud.width * cloud.point_step : 0;
  const std::int64_t least = last_row + (points > 0 ? (cloud.height - 1) * cloud.row_step : 0);
  const auto size = static_cast<std::int64_t>(cloud.data.size());
  const std::int64_t most = std::max(least, cloud.height * cloud.row_step);
  if (size < least || size > most) {
    return reject("size",
                  fmt::format("{}: {} bytes of data for {} x {} points of {} bytes and rows of {}, must be {}",
                              cloud.type, size, cloud.width, cloud.height, cloud.point_step, cloud.row_step, most));
  }
  return static_cast<std::size_t>(points);
}

template <class Float, class Word>
Float number_at(const std::uint8_t* bytes, bool is_big_endian) {
  Word word = 0;
  std::memcpy(&word, bytes, sizeof word);
  if (is_big_endian) {
    if constexpr (sizeof(Word) == 4) {
      word = __builtin_bswap32(word);
    } else {
      word = __builtin_bswap64(word);
    }
  }
  return std::bit_cast<Float>(word);
}

float coordinate_at(const std::uint8_t* point, const Coordinate& at, bool is_big_endian) {
  if (!at.is_double) return number_at<float, std::uint32_t>(point + at.offset, is_big_endian);
  const auto value = number_at<double, std::uint64_t>(point + at.offset, is_big_endian);
  // What a float cannot hold is no point of a room.
  constexpr double kMost = std::numeric_limits<float>::max();
  return std::abs(value) <= kMost ? static_cast<float>(value) : std::numeric_limits<float>::quiet_NaN();
}

Decoded<DecodedScan> to_point_scan(const WireCloud& cloud, const ScanFormat& format, std::size_t max_bytes) {
  if (cloud.utime <= 0) return reject("time", fmt::format("{}: utime is {}, must be > 0", cloud.type, cloud.utime));
  if (!format.frame.empty() && cloud.frame != format.frame) {
    return reject("frame", fmt::format("{}: the cloud is of frame '{}', inputs[].frame is '{}'", cloud.type,
                                       cloud.frame.substr(0, 80), format.frame));
  }
  const auto points = check_layout(cloud, max_bytes);
  if (!points) return tl::make_unexpected(points.error());
  const auto coordinates = coordinates_of(cloud);
  if (!coordinates) return tl::make_unexpected(coordinates.error());
  PointScan scan;
  scan.utime = cloud.utime;
  scan.xyz_m.resize(3 * *points);
  auto out = scan.xyz_m.begin();
  for (std::int64_t row = 0; row < (*points > 0 ? cloud.height : 0); ++row) {
    const std::uint8_t* point = cloud.data.data() + row * cloud.row_step;
    for (std::int64_t i = 0; i < cloud.width; ++i, point += cloud.point_step) {
      for (const Coordinate& at : *coordinates) *out++ = coordinate_at(point, at, cloud.is_big_endian);
    }
  }
  return DecodedScan{std::move(scan), cloud.seq};
}

}  // namespace

Decoded<DecodedScan> decode_point_cloud2(WireReader reader, const ScanFormat& format, std::size_t max_bytes) {
  WireCloud cloud;
  cloud.type = "pointcloud2_t";
  cloud.utime = reader.i64();
  cloud.seq = reader.i32();
  cloud.frame = reader.text();
  cloud.height = reader.i32();
  cloud.width = reader.i32();
  cloud.fields = read_fields(reader);
  cloud.is_big_endian = reader.boolean();
  cloud.point_step = reader.i32();
  cloud.row_step = reader.i32();
  cloud.data = reader.bytes(reader.count(1));
  reader.boolean();  // is_dense
  if (const auto end = check_end(reader, cloud.type); !end) return tl::make_unexpected(end.error());
  return to_point_scan(cloud, format, max_bytes);
}

Decoded<DecodedScan> decode_point_cloud(WireReader reader, const ScanFormat& format, std::size_t max_bytes) {
  WireCloud cloud;
  cloud.type = "lcmt_point_cloud";
  cloud.utime = reader.i64();
  cloud.frame = reader.text();
  cloud.width = reader.i64();
  cloud.height = reader.i64();
  cloud.fields = read_fields(reader);
  cloud.is_big_endian = (reader.i64() & drake::lcmt_point_cloud::IS_BIGENDIAN) != 0;
  cloud.point_step = reader.i32();
  cloud.row_step = reader.i64();
  const std::int16_t filler = reader.i16();
  if (filler < 0) return reject("size", fmt::format("{}: filler_size is {}", cloud.type, filler));
  reader.bytes(static_cast<std::size_t>(filler));
  const std::int64_t size = reader.i64();
  if (reader.ok() && (size < 0 || static_cast<std::size_t>(size) != reader.remaining())) {
    return reject("size",
                  fmt::format("{}: data_size is {}, but {} bytes follow", cloud.type, size, reader.remaining()));
  }
  cloud.data = reader.bytes(reader.remaining());
  if (const auto end = check_end(reader, cloud.type); !end) return tl::make_unexpected(end.error());
  return to_point_scan(cloud, format, max_bytes);
}

}  // namespace planemap::service

#include "codec/scan_codec.hpp"

#include <spdlog/fmt/fmt.h>

#include "codec/scans/families.hpp"

namespace planemap::service {
namespace {

Decoded<const KnownType*> wanted_type(std::span<const std::uint8_t> message, const ScanFormat& format) {
  if (message.size() < 8) {
    return reject("truncated", fmt::format("a message of {} bytes, shorter than a fingerprint", message.size()));
  }
  const std::uint64_t fingerprint = fingerprint_of(message);
  const KnownType* type = known_type(fingerprint);
  if (type == nullptr) {
    return reject("unknown_type", fmt::format("fingerprint {} is none of the types that carry scans: {}",
                                              fingerprint_text(fingerprint), scan_types_text()));
  }
  if (type->family == ScanFamily::kAuto) {
    return reject("wrong_channel",
                  fmt::format("{} ({}) is {}", type->name, fingerprint_text(fingerprint), type->belongs));
  }
  if (format.family != ScanFamily::kAuto && type->family != format.family) {
    return reject("wrong_channel", fmt::format("{} ({}) is a scan of another family than inputs[].family says: {} ({})",
                                               type->name, fingerprint_text(fingerprint), type_of(format.family).name,
                                               fingerprint_text(type_of(format.family).fingerprint)));
  }
  return type;
}

}  // namespace

Decoded<void> check_end(const WireReader& reader, const char* type) {
  if (!reader.ok()) {
    return reject("truncated", fmt::format("{}: ends within a member, or a count says more than follows", type));
  }
  if (reader.remaining() != 0) return reject("size", fmt::format("{}: {} bytes too many", type, reader.remaining()));
  return {};
}

Decoded<DecodedScan> decode_scan(std::span<const std::uint8_t> message, std::size_t max_bytes,
                                 const ScanFormat& format) {
  const auto type = wanted_type(message, format);
  if (!type) return tl::make_unexpected(type.error());
  const WireReader reader(message.subspan(8));
  switch ((*type)->family) {
    case ScanFamily::kDepthScan:
      return decode_depth_scan(reader, message.size(), max_bytes);
    case ScanFamily::kPointScan:
      return decode_point_scan(reader, max_bytes);
    case ScanFamily::kKinectFrame:
      return decode_kinect_frame(reader, format, max_bytes);
    case ScanFamily::kImages:
      return decode_images(reader, format, max_bytes);
    case ScanFamily::kImage:
      return decode_image(reader, format, max_bytes);
    case ScanFamily::kImageArray:
      return decode_image_array(reader, format, max_bytes);
    case ScanFamily::kPointCloud2:
      return decode_point_cloud2(reader, format, max_bytes);
    case ScanFamily::kPointCloud:
      return decode_point_cloud(reader, format, max_bytes);
    case ScanFamily::kAuto:
      break;
  }
  return reject("unknown_type", "a type without a decoder");
}

}  // namespace planemap::service

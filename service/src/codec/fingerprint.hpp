#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "codec/scan_format.hpp"

namespace planemap::service {

/// The first 8 bytes of an LCM message, which name its type; 0 if it is shorter.
std::uint64_t fingerprint_of(std::span<const std::uint8_t> message);
/// "0x2e16efb052b0105e"
std::string fingerprint_text(std::uint64_t fingerprint);

/// A type that comes in somewhere.
struct KnownType {
  std::uint64_t fingerprint;
  const char* name;     ///< "bot_core.pose_t"
  ScanFamily family;    ///< kAuto for those that are no scans
  const char* belongs;  ///< in words, where it comes in
};

/// The type of that fingerprint, scan or not; nullptr: not known.
const KnownType* known_type(std::uint64_t fingerprint);
/// The scan type of a family. @pre not kAuto
const KnownType& type_of(ScanFamily family);
/// "planemap_lcm.depth_scan_t (0x...), ...": all that may carry a scan.
std::string scan_types_text();

}  // namespace planemap::service

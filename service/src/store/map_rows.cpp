#include "store/map_rows.hpp"

#include <spdlog/fmt/fmt.h>
#include <zlib.h>

#include "common/byte_stream.hpp"

namespace planemap::service {
namespace {

std::uint32_t checksum(std::span<const std::uint8_t> head, std::span<const std::uint8_t> bytes) {
  uLong crc = crc32(0, head.data(), static_cast<uInt>(head.size()));
  crc = crc32(crc, bytes.data(), static_cast<uInt>(bytes.size()));
  return static_cast<std::uint32_t>(crc);
}

}  // namespace

std::uint32_t block_checksum(std::int64_t slot, const BlockIndex& index, std::size_t cells,
                             std::span<const std::uint8_t> bytes) {
  ByteWriter<> head;
  head.put(slot);
  for (const int i : index) head.put(static_cast<std::int32_t>(i));
  head.put(static_cast<std::uint64_t>(cells));
  return checksum(head.bytes(), bytes);
}

std::uint32_t plane_checksum(PlaneId id, std::span<const std::uint8_t> bytes) {
  ByteWriter<> head;
  head.put(id);
  return checksum(head.bytes(), bytes);
}

std::uint32_t removed_checksum(const RemovedPlane& removed) {
  ByteWriter<> head;
  head.put(removed.id);
  head.put(removed.merged_into);
  head.put(removed.revision);
  return checksum(head.bytes(), {});
}

std::string facts_checksum(const FactRows& facts) {
  std::string all;
  for (const auto& [key, value] : facts) {
    if (key == "checksum") continue;
    all.append(key).push_back('\0');
    all.append(value).push_back('\0');
  }
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(all.data());
  return fmt::format("{:08x}", checksum({bytes, all.size()}, {}));
}

std::string text_of(double number) {
  return fmt::format("{:.17g}", number);
}

}  // namespace planemap::service

#include "store/packing.hpp"

#include <zlib.h>

#include <stdexcept>
#include <string>

namespace planemap::service {
namespace {

constexpr std::size_t kHeadBytes = 4;

}  // namespace

Bytes packed(std::span<const std::uint8_t> raw) {
  uLongf size = compressBound(static_cast<uLong>(raw.size()));
  ByteWriter<> writer;
  writer.put(static_cast<std::uint32_t>(raw.size()));
  Bytes& bytes = writer.bytes();
  bytes.resize(kHeadBytes + size);
  if (compress2(bytes.data() + kHeadBytes, &size, raw.data(), static_cast<uLong>(raw.size()), Z_DEFAULT_COMPRESSION) !=
      Z_OK) {
    throw std::runtime_error("zlib cannot compress: out of memory");
  }
  bytes.resize(kHeadBytes + size);
  return std::move(bytes);
}

Expected<Bytes> unpacked(std::span<const std::uint8_t> bytes, std::size_t most) {
  ByteReader reader(bytes);
  const auto size = reader.get<std::uint32_t>();
  if (!reader.ok() || size > most) return fail("its size is out of range");
  Bytes raw(size);
  uLongf written = size;
  const auto rest = reader.bytes(reader.remaining());
  const int result = uncompress(raw.data(), &written, rest.data(), static_cast<uLong>(rest.size()));
  if (result != Z_OK || written != size) return fail("it cannot be decompressed");
  return raw;
}

}  // namespace planemap::service

#include "serve/http/cells_blob.hpp"

#include <limits>
#include <planemap/block.hpp>

#include "common/byte_stream.hpp"

namespace planemap::service {
namespace {

constexpr std::uint32_t kMagic = 0x434D4C50;  // "PLMC"
constexpr std::uint32_t kVersion = 1;

void put_cell(ByteWriter<std::string>& out, const CellView& cell) {
  for (const double x : cell.centre_m) out.put(static_cast<float>(x));
  const Eigen::Vector3d normal = cell.normal.value_or(Eigen::Vector3d::Zero());
  for (const double x : normal) out.put(static_cast<float>(x));
  out.put(cell.normal ? static_cast<float>(cell.deviation_rad) : std::numeric_limits<float>::quiet_NaN());
  out.put(static_cast<std::uint32_t>(cell.plane_id));
}

}  // namespace

std::string cells_blob(const MapSheet& sheet, std::optional<std::uint64_t> since) {
  const MapSnapshot& snapshot = sheet.snapshot();
  const std::uint64_t known = since.value_or(0);
  const bool is_full = !since.has_value() || known < sheet.complete_since() || known > snapshot.revision();
  ByteWriter<std::string> out;
  out.put(kMagic);
  out.put(kVersion);
  out.put(snapshot.epoch());
  out.put(snapshot.revision());
  out.put(std::uint32_t{is_full ? 1U : 0U});
  const std::size_t block_count_at = out.size();
  out.put(std::uint32_t{0});
  std::uint32_t block_count = 0;
  const auto& blocks = snapshot.blocks();
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    if (!is_full && sheet.block_revisions()[i] <= known) continue;
    const Block& block = *blocks[i];
    const std::size_t begin = out.size();
    for (const int x : block.index()) out.put(static_cast<std::int32_t>(x));
    const std::size_t cell_count_at = out.size();
    out.put(std::uint32_t{0});
    std::uint32_t cell_count = 0;
    for (std::size_t ordinal = 0; ordinal < block.size(); ++ordinal) {
      if (!snapshot.is_dense(block.cell(ordinal))) continue;
      put_cell(out, snapshot.view_of(block, ordinal));
      ++cell_count;
    }
    if (cell_count == 0 && is_full) {  // who gets all blocks has none to take back
      out.bytes().resize(begin);
      continue;
    }
    out.patch(cell_count_at, cell_count);
    ++block_count;
  }
  out.patch(block_count_at, block_count);
  return std::move(out.bytes());
}

}  // namespace planemap::service

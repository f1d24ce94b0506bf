#include "store/block_codec.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <vector>

#include "store/packing.hpp"

namespace planemap::service {
namespace {

// A cell's head: its place, and what else there is of it.
constexpr unsigned kPlaceMask = 0x1ff;
constexpr unsigned kIsSecond = 1U << 9U;
constexpr unsigned kHasPoints = 1U << 10U;
constexpr unsigned kHasEvidence = 1U << 11U;
constexpr unsigned kHasEvidenceCount = 1U << 12U;  ///< else as many as points
constexpr unsigned kHasNormal = 1U << 13U;
constexpr unsigned kHasWeight = 1U << 14U;    ///< a share between 0 and 1
constexpr unsigned kWeightIsOne = 1U << 15U;  ///< else, without kHasWeight: 0

constexpr std::size_t kMostCells = 2 * kBlockCells;
constexpr std::size_t kCellBytes = 128;  ///< more than any cell takes
constexpr std::size_t kMostBytes = 16 + kMostCells * (kCellBytes + 4);

/// The upper half of a float, rounded to nearest: 8 digits.
std::uint16_t half_of(float x) {
  const std::uint32_t bits = std::bit_cast<std::uint32_t>(x);
  return static_cast<std::uint16_t>((bits + 0x7fff + ((bits >> 16) & 1)) >> 16);
}
float from_half(std::uint16_t half) {
  return std::bit_cast<float>(static_cast<std::uint32_t>(half) << 16);
}

/// A unit vector on the octahedron, 16 bits an axis (Cigolle et al., JCGT 3(2), 2014).
std::array<std::int16_t, 2> octahedral(const Eigen::Vector3f& n) {
  const float sum = n.cwiseAbs().sum();
  Eigen::Vector2f p = n.head<2>() / sum;
  if (n.z() < 0.0F) {
    p = Eigen::Vector2f((1.0F - std::abs(p.y())) * (p.x() >= 0.0F ? 1.0F : -1.0F),
                        (1.0F - std::abs(p.x())) * (p.y() >= 0.0F ? 1.0F : -1.0F));
  }
  const auto step = [](float x) {
    return static_cast<std::int16_t>(std::lround(std::clamp(x, -1.0F, 1.0F) * 32767.0F));
  };
  return {step(p.x()), step(p.y())};
}
Eigen::Vector3f from_octahedral(std::int16_t x, std::int16_t y) {
  const Eigen::Vector2f p = Eigen::Vector2f(x, y) / 32767.0F;
  Eigen::Vector3f n(p.x(), p.y(), 1.0F - p.cwiseAbs().sum());
  if (n.z() < 0.0F) {
    n.head<2>() = Eigen::Vector2f((1.0F - std::abs(p.y())) * (p.x() >= 0.0F ? 1.0F : -1.0F),
                                  (1.0F - std::abs(p.x())) * (p.y() >= 0.0F ? 1.0F : -1.0F));
  }
  return n.normalized();
}

unsigned head_of(const Cell& cell, int place) {
  const bool normal = cell.has_normal() || cell.normal_count > 0.0F || cell.deviation_rad > 0.0F;
  const bool whole = cell.evidence_count == static_cast<float>(cell.sums.count);
  const bool share = cell.plane_weight != 0.0F && cell.plane_weight != 1.0F;
  return static_cast<unsigned>(place) | (cell.is_second ? kIsSecond : 0U) | (cell.sums.count > 0.0 ? kHasPoints : 0U) |
         (cell.has_evidence() ? kHasEvidence : 0U) | (whole ? 0U : kHasEvidenceCount) | (normal ? kHasNormal : 0U) |
         (share ? kHasWeight : 0U) | (cell.plane_weight == 1.0F ? kWeightIsOne : 0U);
}

/// Calls visit(field, which cells have it) for each field, by reference to a number of its type on file. One list for
/// reading and writing: column is a function of (head flag or 0, size in bytes, get, set).
template <class Column>
void visit_columns(Column&& column) {
  using U16 = std::uint16_t;
  const auto floats = [&](unsigned flag, auto member) {
    column(
        flag, float{}, [member](Cell& c) { return member(c); }, [member](Cell& c, float x) { member(c) = x; });
  };
  const auto halves = [&](unsigned flag, auto member) {
    column(
        flag, U16{}, [member](Cell& c) { return half_of(member(c)); },
        [member](Cell& c, U16 x) { member(c) = from_half(x); });
  };
  column(
      kHasPoints, std::uint64_t{}, [](Cell& c) { return static_cast<std::uint64_t>(std::llround(c.sums.count)); },
      [](Cell& c, std::uint64_t x) { c.sums.count = static_cast<double>(x); });
  for (Eigen::Index i = 0; i < 3; ++i) {
    column(
        kHasPoints, float{}, [i](Cell& c) { return static_cast<float>(c.sums.first_m[i]); },
        [i](Cell& c, float x) { c.sums.first_m[i] = static_cast<double>(x); });
  }
  for (Eigen::Index i = 0; i < 3; ++i) halves(kHasPoints, [i](Cell& c) -> float& { return c.sums.square_m2[i]; });
  for (Eigen::Index i = 0; i < 3; ++i) halves(kHasPoints, [i](Cell& c) -> float& { return c.sums.error_m2[i]; });
  for (Eigen::Index i = 0; i < 3; ++i) halves(kHasPoints, [i](Cell& c) -> float& { return c.sums.view[i]; });
  floats(kHasEvidence, [](Cell& c) -> float& { return c.evidence.weight; });
  for (Eigen::Index i = 0; i < 3; ++i) floats(kHasEvidence, [i](Cell& c) -> float& { return c.evidence.first[i]; });
  for (std::size_t i = 0; i < 6; ++i) floats(kHasEvidence, [i](Cell& c) -> float& { return c.evidence.second[i]; });
  floats(kHasEvidenceCount, [](Cell& c) -> float& { return c.evidence_count; });
  column(
      kHasNormal, std::uint32_t{},
      [](Cell& c) {
        if (!c.has_normal()) return std::uint32_t{0x80008000};  // no step of the octahedron
        const auto n = octahedral(c.normal);
        return static_cast<std::uint32_t>(static_cast<U16>(n[0])) | static_cast<std::uint32_t>(static_cast<U16>(n[1]))
                                                                        << 16;
      },
      [](Cell& c, std::uint32_t x) {
        if (x == 0x80008000) return;
        c.normal = from_octahedral(static_cast<std::int16_t>(x & 0xffff), static_cast<std::int16_t>(x >> 16));
      });
  halves(kHasNormal, [](Cell& c) -> float& { return c.deviation_rad; });
  halves(kHasNormal, [](Cell& c) -> float& { return c.normal_count; });
  floats(kHasWeight, [](Cell& c) -> float& { return c.plane_weight; });
}

/// Counts take 5 bytes: 10^12 points.
template <class T>
constexpr std::size_t kColumnBytes = sizeof(T) == 8 ? 5 : sizeof(T);

}  // namespace

Bytes encode_block(const Block& block) {
  ByteWriter writer;
  std::vector<PlaneSlot> palette;
  std::vector<std::uint16_t> heads;
  std::vector<Cell> cells;
  heads.reserve(block.size());
  cells.reserve(block.size());
  for (std::size_t i = 0; i < block.size(); ++i) {
    cells.push_back(block.cell(i));
    heads.push_back(static_cast<std::uint16_t>(head_of(block.cell(i), block.place(i))));
    if (std::find(palette.begin(), palette.end(), block.cell(i).plane) == palette.end()) {
      palette.push_back(block.cell(i).plane);
    }
  }
  writer.put(static_cast<std::uint16_t>(block.size()));
  writer.put(static_cast<std::uint16_t>(palette.size()));
  for (const PlaneSlot plane : palette) writer.put(plane);
  for (const std::uint16_t head : heads) writer.put(head);
  for (const Cell& cell : cells) {
    const auto at = std::find(palette.begin(), palette.end(), cell.plane) - palette.begin();
    writer.put(static_cast<std::uint16_t>(at));
  }
  Bytes& bytes = writer.bytes();
  // Byte by byte of all cells: exponents are alike and compress, the last digits don't.
  visit_columns([&](unsigned flag, auto type, auto get, auto) {
    using T = decltype(type);
    for (std::size_t byte = 0; byte < kColumnBytes<T>; ++byte) {
      for (std::size_t i = 0; i < cells.size(); ++i) {
        if ((heads[i] & flag) == 0) continue;
        const T value = get(cells[i]);
        std::array<std::uint8_t, sizeof(T)> raw;
        std::memcpy(raw.data(), &value, sizeof(T));
        bytes.push_back(raw[byte]);
      }
    }
  });
  return packed(bytes);
}

Expected<std::shared_ptr<Block>> decode_block(const BlockIndex& index, std::span<const std::uint8_t> bytes) {
  const auto raw = unpacked(bytes, kMostBytes);
  if (!raw) return tl::make_unexpected(raw.error());
  ByteReader reader(*raw);
  const std::size_t count = reader.get<std::uint16_t>();
  const std::size_t colours = reader.get<std::uint16_t>();
  if (count > kMostCells || colours > count) return fail("it has more cells than a block has places");
  std::vector<PlaneSlot> palette(colours);
  for (PlaneSlot& plane : palette) plane = reader.get<PlaneSlot>();
  std::vector<std::uint16_t> heads(count);
  for (auto& head : heads) head = reader.get<std::uint16_t>();
  auto block = std::make_shared<Block>(index);
  block->reserve(count);
  for (const std::uint16_t head : heads) {
    const int place = static_cast<int>(head & kPlaceMask);
    const std::size_t before = block->size();
    if ((head & kIsSecond) == 0) {
      block->find_or_add(place);
    } else if (const int first = block->find(place); first >= 0) {
      block->find_or_add_second(first);
    }
    if (block->size() != before + 1) return fail("a place has too many cells, or a second one without a first");
  }
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t at = reader.get<std::uint16_t>();
    if (at >= palette.size()) return fail("a cell has a label that the block does not list");
    block->cell(i).plane = palette[at];
    block->cell(i).plane_weight = (heads[i] & kWeightIsOne) != 0 ? 1.0F : 0.0F;
  }
  visit_columns([&](unsigned flag, auto type, auto, auto set) {
    using T = decltype(type);
    const auto has = static_cast<std::size_t>(
        std::count_if(heads.begin(), heads.end(), [&](std::uint16_t head) { return (head & flag) != 0; }));
    const auto column = reader.bytes(has * kColumnBytes<T>);
    if (column.empty()) return;
    for (std::size_t i = 0, k = 0; i < count; ++i) {
      if ((heads[i] & flag) == 0) continue;
      std::array<std::uint8_t, sizeof(T)> one{};
      for (std::size_t byte = 0; byte < kColumnBytes<T>; ++byte) one[byte] = column[byte * has + k];
      T value;
      std::memcpy(&value, one.data(), sizeof(T));
      set(block->cell(i), value);
      ++k;
    }
  });
  for (std::size_t i = 0; i < count; ++i) {
    Cell& cell = block->cell(i);
    if ((heads[i] & kHasEvidenceCount) == 0) cell.evidence_count = static_cast<float>(cell.sums.count);
  }
  if (!reader.ok() || reader.remaining() != 0) return fail("it is cut short, or too long");
  return block;
}

}  // namespace planemap::service

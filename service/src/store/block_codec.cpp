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

constexpr std::uint32_t kNoNormal = 0x80008000;  ///< no step of the octahedron

constexpr std::size_t kMostCells = 2 * kBlockCells;
constexpr std::size_t kSmoothBytes = 64;  ///< more than there are of any cell
constexpr std::size_t kMostBytes = 16 + kMostCells * kSmoothBytes;

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

// What a cell's exponents are told from: they grow with its points, and with its evidence's weight.
constexpr auto kNoReference = [](const Cell&) { return 0U; };
constexpr auto kCount = [](const Cell& c) {
  return static_cast<unsigned>(std::bit_width(static_cast<std::uint64_t>(std::llround(c.sums.count))));
};
constexpr auto kWeight = [](const Cell& c) { return (std::bit_cast<std::uint32_t>(c.evidence.weight) >> 23U) & 0xffU; };

/// A column of floats or of their upper halves: exponents first, sign last, and the exponent told from a reference.
template <class Unsigned>
Unsigned turned(Unsigned bits, unsigned reference) {
  constexpr int kTop = 8 * sizeof(Unsigned) - 8;
  const Unsigned exponent_first = std::rotl(bits, 1);
  return static_cast<Unsigned>(exponent_first - (static_cast<Unsigned>(reference) << kTop));
}
template <class Unsigned>
Unsigned turned_back(Unsigned turned, unsigned reference) {
  constexpr int kTop = 8 * sizeof(Unsigned) - 8;
  return std::rotr(static_cast<Unsigned>(turned + (static_cast<Unsigned>(reference) << kTop)), 1);
}

/// Which bytes of a column's numbers are alike from cell to cell, and compress; the others are noise.
template <class T>
struct Column {
  unsigned flag;          ///< which cells have it
  std::size_t bytes;      ///< of each number, from the lowest
  unsigned smooth_bytes;  ///< bit n: byte n compresses
};

/// Calls column(Column<T>, get(cell), set(cell, number)) for each field, in the order on file: one list for writing and
/// reading. What a number is told from stands before it.
template <class Visit>
void visit_columns(Visit&& column) {
  using U16 = std::uint16_t;
  using U32 = std::uint32_t;
  const auto floats = [&](unsigned flag, auto reference, auto member) {
    column(
        Column<U32>{flag, 4, 0b1000},
        [=](Cell& c) { return turned(std::bit_cast<U32>(static_cast<float>(member(c))), reference(c)); },
        [=](Cell& c, U32 x) { member(c) = std::bit_cast<float>(turned_back(x, reference(c))); });
  };
  const auto halves = [&](unsigned flag, auto reference, auto member) {
    column(
        Column<U16>{flag, 2, 0b10}, [=](Cell& c) { return turned(half_of(member(c)), reference(c)); },
        [=](Cell& c, U16 x) { member(c) = from_half(turned_back(x, reference(c))); });
  };
  column(
      Column<std::uint64_t>{kHasPoints, 5, 0b11110},  // up to 10^12 points
      [](Cell& c) { return static_cast<std::uint64_t>(std::llround(c.sums.count)); },
      [](Cell& c, std::uint64_t x) { c.sums.count = static_cast<double>(x); });
  for (Eigen::Index i = 0; i < 3; ++i) {
    floats(kHasPoints, kCount, [i](Cell& c) -> double& { return c.sums.first_m[i]; });
  }
  for (Eigen::Index i = 0; i < 3; ++i) {
    halves(kHasPoints, kCount, [i](Cell& c) -> float& { return c.sums.square_m2[i]; });
  }
  for (Eigen::Index i = 0; i < 3; ++i) {
    halves(kHasPoints, kCount, [i](Cell& c) -> float& { return c.sums.error_m2[i]; });
  }
  for (Eigen::Index i = 0; i < 3; ++i) {
    halves(kHasPoints, kCount, [i](Cell& c) -> float& { return c.sums.view[i]; });
  }
  floats(kHasEvidence, kCount, [](Cell& c) -> float& { return c.evidence.weight; });
  for (Eigen::Index i = 0; i < 3; ++i) {
    floats(kHasEvidence, kWeight, [i](Cell& c) -> float& { return c.evidence.first[i]; });
  }
  for (std::size_t i = 0; i < 6; ++i) {
    floats(kHasEvidence, kWeight, [i](Cell& c) -> float& { return c.evidence.second[i]; });
  }
  floats(kHasEvidenceCount, kCount, [](Cell& c) -> float& { return c.evidence_count; });
  column(
      Column<U32>{kHasNormal, 4, 0b1010},
      [](Cell& c) {
        if (!c.has_normal()) return kNoNormal;
        const auto n = octahedral(c.normal);
        return static_cast<U32>(static_cast<U16>(n[0])) | static_cast<U32>(static_cast<U16>(n[1])) << 16;
      },
      [](Cell& c, U32 x) {
        if (x == kNoNormal) return;
        c.normal = from_octahedral(static_cast<std::int16_t>(x & 0xffff), static_cast<std::int16_t>(x >> 16));
      });
  halves(kHasNormal, kNoReference, [](Cell& c) -> float& { return c.deviation_rad; });
  halves(kHasNormal, kCount, [](Cell& c) -> float& { return c.normal_count; });
  floats(kHasWeight, kNoReference, [](Cell& c) -> float& { return c.plane_weight; });
}

/// The two streams of bytes that a block becomes.
struct Streams {
  ByteWriter<> smooth;
  ByteWriter<> noise;
};

/// Byte by byte of all numbers.
template <class T>
void put_bytes(Streams& streams, const std::vector<T>& numbers, std::size_t bytes, unsigned smooth_bytes) {
  for (std::size_t byte = 0; byte < bytes; ++byte) {
    auto& stream = ((smooth_bytes >> byte) & 1U) != 0 ? streams.smooth : streams.noise;
    for (const T number : numbers) stream.put(static_cast<std::uint8_t>(number >> (8 * byte)));
  }
}

struct StreamReaders {
  ByteReader smooth;
  ByteReader noise;
  bool ok() const { return smooth.ok() && noise.ok(); }
  bool at_end() const { return smooth.remaining() == 0 && noise.remaining() == 0; }
};

template <class T>
std::vector<T> get_bytes(StreamReaders& streams, std::size_t count, std::size_t bytes, unsigned smooth_bytes) {
  std::vector<T> numbers(count, 0);
  for (std::size_t byte = 0; byte < bytes; ++byte) {
    const auto column = (((smooth_bytes >> byte) & 1U) != 0 ? streams.smooth : streams.noise).bytes(count);
    for (std::size_t i = 0; i < column.size(); ++i) {
      numbers[i] = static_cast<T>(numbers[i] | static_cast<T>(static_cast<T>(column[i]) << (8 * byte)));
    }
  }
  return numbers;
}

constexpr unsigned kSmoothHead = 0b10;  ///< places are noise but for their highest bit
constexpr unsigned kAllSmooth = 0b11;

}  // namespace

Bytes encode_block(const Block& block) {
  std::vector<PlaneSlot> palette;
  std::vector<std::uint16_t> heads;
  std::vector<std::uint16_t> labels;
  std::vector<Cell> cells;
  heads.reserve(block.size());
  labels.reserve(block.size());
  cells.reserve(block.size());
  for (std::size_t i = 0; i < block.size(); ++i) {
    const Cell& cell = block.cell(i);
    cells.push_back(cell);
    heads.push_back(static_cast<std::uint16_t>(head_of(cell, block.place(i))));
    const auto at = std::find(palette.begin(), palette.end(), cell.plane);
    labels.push_back(static_cast<std::uint16_t>(at - palette.begin()));
    if (at == palette.end()) palette.push_back(cell.plane);
  }
  Streams streams;
  streams.smooth.put(static_cast<std::uint16_t>(block.size()));
  streams.smooth.put(static_cast<std::uint16_t>(palette.size()));
  for (const PlaneSlot plane : palette) streams.smooth.put(plane);
  put_bytes(streams, heads, 2, kSmoothHead);
  put_bytes(streams, labels, 2, kAllSmooth);
  visit_columns([&]<class T>(const Column<T>& column, auto get, auto) {
    std::vector<T> numbers;
    numbers.reserve(cells.size());
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if ((heads[i] & column.flag) != 0) numbers.push_back(get(cells[i]));
    }
    put_bytes(streams, numbers, column.bytes, column.smooth_bytes);
  });
  const Bytes smooth = packed(streams.smooth.bytes());
  ByteWriter<> all;
  all.put(static_cast<std::uint32_t>(smooth.size()));
  all.bytes().insert(all.bytes().end(), smooth.begin(), smooth.end());
  all.bytes().insert(all.bytes().end(), streams.noise.bytes().begin(), streams.noise.bytes().end());
  return std::move(all.bytes());
}

Expected<std::shared_ptr<Block>> decode_block(const BlockIndex& index, std::span<const std::uint8_t> bytes) {
  ByteReader all(bytes);
  const auto smooth = unpacked(all.bytes(all.get<std::uint32_t>()), kMostBytes);
  if (!smooth) return tl::make_unexpected(smooth.error());
  StreamReaders reader{ByteReader(*smooth), ByteReader(all.bytes(all.remaining()))};
  const std::size_t count = reader.smooth.get<std::uint16_t>();
  const std::size_t colours = reader.smooth.get<std::uint16_t>();
  if (count > kMostCells || colours > count) return fail("it has more cells than a block has places");
  std::vector<PlaneSlot> palette(colours);
  for (PlaneSlot& plane : palette) plane = reader.smooth.get<PlaneSlot>();
  const auto heads = get_bytes<std::uint16_t>(reader, count, 2, kSmoothHead);
  const auto labels = get_bytes<std::uint16_t>(reader, count, 2, kAllSmooth);
  if (!reader.ok()) return fail("it is cut short, or too long");
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
    if (labels[i] >= palette.size()) return fail("a cell has a label that the block does not list");
    block->cell(i).plane = palette[labels[i]];
    block->cell(i).plane_weight = (heads[i] & kWeightIsOne) != 0 ? 1.0F : 0.0F;
  }
  visit_columns([&]<class T>(const Column<T>& column, auto, auto set) {
    const auto has = static_cast<std::size_t>(
        std::count_if(heads.begin(), heads.end(), [&](std::uint16_t head) { return (head & column.flag) != 0; }));
    const std::vector<T> numbers = get_bytes<T>(reader, has, column.bytes, column.smooth_bytes);
    for (std::size_t i = 0, k = 0; i < count; ++i) {
      if ((heads[i] & column.flag) != 0) set(block->cell(i), numbers[k++]);
    }
  });
  for (std::size_t i = 0; i < count; ++i) {
    Cell& cell = block->cell(i);
    if ((heads[i] & kHasEvidenceCount) == 0) cell.evidence_count = static_cast<float>(cell.sums.count);
  }
  if (!reader.ok() || !reader.at_end()) return fail("it is cut short, or too long");
  return block;
}

}  // namespace planemap::service

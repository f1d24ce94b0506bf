#include "query_scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <planemap/block.hpp>
#include <vector>

namespace planemap::benchmark {

namespace {

using Eigen::Vector3d;

constexpr double kCellM = 0.1;
constexpr std::size_t kPlanesInRoom = 40;
constexpr std::size_t kFaces = 5;  // of a piece of furniture: all but the one it stands on
const Vector3d kRoomM(4.0, 3.0, 2.6);
const Vector3d kPitchM(4.2, 3.2, 2.8);  // walls between

/// Makes planes and the cells on them.
class Builder {
 public:
  explicit Builder(const Eigen::Isometry3d& T_world_building) : T_(T_world_building) {}

  /// A rectangle from a corner, seen from the side to which u x v points.
  void rectangle(const Vector3d& corner_m, const Vector3d& u_m, const Vector3d& v_m,
                 const Eigen::AlignedBox2d& hole_m) {
    const auto id = static_cast<PlaneId>(records_.size() + 1);
    auto record = std::make_shared<PlaneRecord>();
    record->id = id;
    record->centroid_m = T_ * Vector3d(corner_m + 0.5 * (u_m + v_m));
    record->plane = Plane::through(record->centroid_m, T_.linear() * u_m.cross(v_m).normalized());
    record->covariance = 1e-6 * Eigen::Matrix4d::Identity();
    for (double u = 0.5 * kCellM; u < u_m.norm(); u += kCellM) {
      for (double v = 0.5 * kCellM; v < v_m.norm(); v += kCellM) {
        if (hole_m.contains(Eigen::Vector2d(u, v))) continue;
        record->cell_count += cell(T_ * Vector3d(corner_m + u * u_m.normalized() + v * v_m.normalized()), id) ? 1 : 0;
      }
    }
    records_.push_back(std::move(record));
  }

  MapSnapshot::Parts parts() {
    MapSnapshot::Parts parts;
    parts.epoch = 1;
    parts.revision = 1;
    parts.cell_size_m = kCellM;
    parts.density_threshold = 10;
    parts.planes = std::move(records_);
    parts.cell_count = cells_;
    for (auto& entry : blocks_) parts.blocks.push_back(std::move(entry.second));
    return parts;
  }

 private:
  /// Points of a plane in the cell that holds a place; false: another plane was there before.
  bool cell(const Vector3d& p_m, PlaneId id) {
    const CellIndex index = (p_m / kCellM).array().floor().matrix().cast<int>();
    const BlockIndex b = block_of(index);
    auto& block = blocks_.try_emplace({b.x(), b.y(), b.z()}, nullptr).first->second;
    if (!block) block = std::make_shared<Block>(b);
    Cell& cell = block->cell(static_cast<std::size_t>(block->find_or_add(place_of(index))));
    if (cell.sums.count > 0.0) return false;
    cell.sums.count = 20.0;
    cell.sums.first_m = 20.0 * (p_m - kCellM * (index.cast<double>().array() + 0.5).matrix());
    cell.plane = static_cast<PlaneSlot>(id);
    ++cells_;
    return true;
  }

  Eigen::Isometry3d T_;
  std::vector<std::shared_ptr<const PlaneRecord>> records_;
  std::map<std::array<int, 3>, std::shared_ptr<Block>> blocks_;
  std::size_t cells_ = 0;
};

const Eigen::AlignedBox2d kNoHole;

/// The five faces of a box that stands somewhere.
void add_furniture(Builder& builder, const Vector3d& low_m, const Vector3d& size_m, std::size_t faces) {
  const Vector3d x = size_m.x() * Vector3d::UnitX();
  const Vector3d y = size_m.y() * Vector3d::UnitY();
  const Vector3d z = size_m.z() * Vector3d::UnitZ();
  const std::array<std::array<Vector3d, 3>, kFaces> all = {
      {{low_m + z, x, y}, {low_m, x, z}, {low_m + x, y, z}, {low_m + y, z, x}, {low_m, z, y}}};
  for (std::size_t i = 0; i < std::min(faces, kFaces); ++i) builder.rectangle(all[i][0], all[i][1], all[i][2], kNoHole);
}

void add_room(Builder& builder, const Vector3d& low_m, std::mt19937_64& random) {
  const Vector3d x = kRoomM.x() * Vector3d::UnitX();
  const Vector3d y = kRoomM.y() * Vector3d::UnitY();
  const Vector3d z = kRoomM.z() * Vector3d::UnitZ();
  const Eigen::AlignedBox2d door(Eigen::Vector2d(0.0, 1.0), Eigen::Vector2d(2.0, 1.9));  // along z, along x
  builder.rectangle(low_m, x, y, kNoHole);
  builder.rectangle(low_m + z, y, x, kNoHole);
  builder.rectangle(low_m, z, x, door);
  builder.rectangle(low_m + y, x, z, kNoHole);
  builder.rectangle(low_m, y, z, kNoHole);
  builder.rectangle(low_m + x, z, y, kNoHole);
  const auto within = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  for (std::size_t left = kPlanesInRoom - 6; left > 0; left -= std::min(left, kFaces)) {
    const Vector3d size_m(within(0.4, 1.2), within(0.4, 0.8), within(0.3, 1.0));
    const Vector3d at_m(within(0.2, kRoomM.x() - 1.4), within(0.2, kRoomM.y() - 1.0), within(0.1, 1.4));
    add_furniture(builder, low_m + at_m, size_m, left);
  }
}

}  // namespace

QueryScene::QueryScene(std::size_t planes)
    : rooms_(std::max<std::size_t>(planes / kPlanesInRoom, 1)),
      rooms_in_row_(static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(rooms_))))),
      T_world_building_(Eigen::AngleAxisd(0.3, Vector3d::UnitZ())) {
  Builder builder(T_world_building_);
  std::mt19937_64 random(1);
  for (std::size_t i = 0; i < rooms_; ++i) {
    const Vector3d place(static_cast<double>(i % rooms_in_row_), static_cast<double>(i / rooms_in_row_), 0.0);
    add_room(builder, place.cwiseProduct(kPitchM), random);
  }
  snapshot_ = std::make_shared<const MapSnapshot>(builder.parts());
}

std::shared_ptr<const MapSnapshot> QueryScene::seen_again(std::size_t planes) const {
  const MapSnapshot& now = *snapshot_;
  MapSnapshot::Parts parts;
  parts.epoch = now.epoch();
  parts.revision = now.revision() + 1;
  parts.cell_size_m = now.cell_size_m();
  parts.density_threshold = now.density_threshold();
  parts.cell_count = now.cell_count();
  parts.planes.assign(now.planes().begin(), now.planes().end());
  for (const auto& block : now.blocks()) parts.blocks.push_back(block);
  // 7,919 is prime: different ones of all kinds.
  for (std::size_t i = 0; i < planes; ++i) {
    auto& record = parts.planes[7919 * i % parts.planes.size()];
    record = std::make_shared<const PlaneRecord>(*record);
  }
  return std::make_shared<const MapSnapshot>(std::move(parts));
}

Vector3d QueryScene::place(std::mt19937_64& random) const {
  const auto room = std::uniform_int_distribution<std::size_t>(0, rooms_ - 1)(random);
  const Vector3d low_m =
      Vector3d(static_cast<double>(room % rooms_in_row_), static_cast<double>(room / rooms_in_row_), 0.0)
          .cwiseProduct(kPitchM);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  return T_world_building_ *
         Vector3d(low_m + Vector3d(share(random), share(random), share(random)).cwiseProduct(kRoomM));
}

}  // namespace planemap::benchmark

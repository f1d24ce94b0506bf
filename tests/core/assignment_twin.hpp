#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <planemap/assignment.hpp>
#include <planemap/expected_distance.hpp>
#include <set>
#include <utility>
#include <vector>

#include "commit.hpp"
#include "scan_points.hpp"

namespace planemap::testing {

using Key = std::array<int, 3>;

inline Key key_of(const CellIndex& index) {
  return {index.x(), index.y(), index.z()};
}

/// The assignment as it is written down, without blocks, runs or vectors: for each point, Eq. 7 for the own cell and
/// the 26 around it with the centres of before the scan; an own cell without points takes the point. In doubles, so
/// points that lie within a millionth of a cell of a border between two cells may go either way.
class NaiveGrid {
 public:
  NaiveGrid(double cell_size_m, bool clamp) : size_m_(cell_size_m), clamp_(clamp) {}

  /// What the scan adds to each cell. `ties` gets the points that may be counted elsewhere, for each cell that may gain
  /// or lose one.
  template <class ScanType>
  std::map<Key, ScanSums> assign(const UncertainGrid& grid, const ScanType& scan,
                                 const Eigen::Isometry3d& T_world_sensor, std::map<Key, int>& ties) const {
    std::map<Key, ScanSums> added;
    for_each_point(scan, T_world_sensor, SensorConfig{}, [&](const UncertainPoint& point) {
      const Eigen::Vector3d variance = rotate_variances(T_world_sensor.linear(), point.variance_sensor_m2);
      const CellIndex own = (point.p_world_m.array() / size_m_).floor().cast<int>();
      std::set<Key> rivals;
      const CellIndex winner = takes(grid, own, point.p_world_m, variance, rivals);
      note_neighbouring_owns(grid, own, point.p_world_m, variance, rivals);
      rivals.insert(key_of(winner));
      if (rivals.size() > 1) {
        for (const Key& rival : rivals) ++ties[rival];
      }
      ScanSums& cell = added[key_of(winner)];
      const Eigen::Vector3d q = point.p_world_m - centre_m(winner);
      cell.points.add(Moments{1.0, q, Symmetric3::outer(q)});
      cell.error_m2 += variance;
    });
    return added;
  }

 private:
  static constexpr double kTie = 2e-5;  // cells; what floats may lose between the sensor and a cell 60 cells away

  Eigen::Vector3d centre_m(const CellIndex& index) const { return (index.cast<double>().array() + 0.5) * size_m_; }

  /// A point on the border of two cells may be taken to lie in either.
  void note_neighbouring_owns(const UncertainGrid& grid, const CellIndex& own, const Eigen::Vector3d& p,
                              const Eigen::Vector3d& variance, std::set<Key>& rivals) const {
    const Eigen::Vector3d place = p / size_m_ - own.cast<double>();
    for (int axis = 0; axis < 3; ++axis) {
      const int side = place(axis) < kTie ? -1 : (place(axis) > 1.0 - kTie ? 1 : 0);
      if (side == 0) continue;
      rivals.insert(key_of(takes(grid, own + side * CellIndex::Unit(axis), p, variance, rivals)));
    }
  }

  CellIndex takes(const UncertainGrid& grid, const CellIndex& own, const Eigen::Vector3d& p,
                  const Eigen::Vector3d& variance, std::set<Key>& rivals) const {
    std::vector<std::pair<double, CellIndex>> distances;
    bool own_has_points = false;
    for (int z = -1; z <= 1; ++z) {
      for (int y = -1; y <= 1; ++y) {
        for (int x = -1; x <= 1; ++x) {
          const CellIndex index = own + CellIndex(x, y, z);
          const auto found = grid.find(index);
          if (!found || grid.cell(*found).sums.count <= 0.0) continue;
          own_has_points = own_has_points || index == own;
          const CellSums& sums = grid.cell(*found).sums;
          CentreStatistics u{sums.count, sums.first_m, sums.error_m2.cast<double>()};
          if (clamp_) {
            const double half = 0.5 * size_m_ * u.count;
            u.linear = u.linear.cwiseMax(-half).cwiseMin(half);
          }
          u.linear += u.count * centre_m(index);
          distances.emplace_back(expected_squared_distance(p, variance, u), index);
        }
      }
    }
    if (!own_has_points) return own;
    const auto less = [](const auto& a, const auto& b) { return a.first < b.first; };
    const auto best = *std::min_element(distances.begin(), distances.end(), less);
    for (const auto& [distance, index] : distances) {
      if (distance - best.first < kTie * size_m_ * size_m_) rivals.insert(key_of(index));
    }
    return best.second;
  }

  double size_m_;
  bool clamp_;
};

/// Puts the changes of a scan into the grid, as the mapper does.
inline void commit(UncertainGrid& grid, Assigner& assigner) {
  commit(grid, assigner.changes());
  assigner.finish(grid);
}

/// The changes must be the twin's, but for ties, to what floats leave of the sums.
inline void expect_same(const UncertainGrid& grid, const std::vector<CellChange>& changes,
                        std::map<Key, ScanSums> expected, const std::map<Key, int>& ties) {
  const auto ties_of = [&](const Key& key) {
    const auto found = ties.find(key);
    return found == ties.end() ? 0 : found->second;
  };
  for (const CellChange& change : changes) {
    const Key key = key_of(grid.index_of(change.cell));
    const ScanSums twin = expected[key];
    expected.erase(key);
    const double count = change.added.count();
    ASSERT_LE(std::abs(count - twin.count()), ties_of(key)) << key[0] << " " << key[1] << " " << key[2];
    if (ties_of(key) > 0) continue;
    // Sums of n numbers of up to a cell's size, or its square: a few digits of a float's seven are left to rounding.
    const double size_m = grid.cell_size_m();
    EXPECT_LT((change.added.points.first - twin.points.first).cwiseAbs().maxCoeff(), 2e-5 * size_m * count);
    EXPECT_LT((change.added.points.second.matrix() - twin.points.second.matrix()).cwiseAbs().maxCoeff(),
              2e-5 * size_m * size_m * count);
    EXPECT_TRUE(change.added.error_m2.isApprox(twin.error_m2, 1e-5));
  }
  for (const auto& [key, sums] : expected) EXPECT_LE(sums.count(), ties_of(key));
}

}  // namespace planemap::testing

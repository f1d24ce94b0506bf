#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

namespace planemap {

/// A line with a beginning, made ready to be met with boxes.
struct RayLine {
  RayLine(const Eigen::Vector3d& origin, const Eigen::Vector3d& unit_direction)
      : origin_m(origin), direction(unit_direction), inverse(unit_direction.cwiseInverse()) {}

  Eigen::Vector3d origin_m;
  Eigen::Vector3d direction;  ///< unit
  Eigen::Vector3d inverse;    ///< of the direction's coordinates

  Eigen::Vector3d at(double range_m) const { return origin_m + range_m * direction; }
  /// Range at which the ray enters a box, 0 if it starts in it; infinity: it passes by.
  double entry_m(const Eigen::AlignedBox3d& box) const;
};

/// Bounding volume hierarchy over boxes: which come near a point, are met by a ray, or touch another box? Immutable.
class PlaneTree {
 public:
  using Item = std::uint32_t;  ///< place of a box in what the tree was made from

  PlaneTree() = default;
  /// Empty boxes are in no answer.
  explicit PlaneTree(std::span<const Eigen::AlignedBox3d> boxes);

  /// Calls limit_m = visit(item, limit_m) for items whose boxes are within limit_m of the point, near ones first as far
  /// as the tree knows.
  template <class Visit>
  void visit_near(const Eigen::Vector3d& p_m, double limit_m, Visit&& visit) const {
    const auto distance_m = [&](const Eigen::AlignedBox3d& box) { return std::sqrt(box.squaredExteriorDistance(p_m)); };
    visit_ordered(distance_m, limit_m, visit);
  }
  /// The same along a ray: boxes that it enters within limit_m.
  template <class Visit>
  void visit_along(const RayLine& ray, double limit_m, Visit&& visit) const {
    visit_ordered([&](const Eigen::AlignedBox3d& box) { return ray.entry_m(box); }, limit_m, visit);
  }
  /// Calls visit(item) for each item whose box touches a box.
  template <class Visit>
  void visit_within(const Eigen::AlignedBox3d& within, Visit&& visit) const {
    const auto miss_m = [&](const Eigen::AlignedBox3d& box) { return within.intersects(box) ? 0.0 : 1.0; };
    visit_ordered(miss_m, 0.0, [&](Item item, double limit_m) {
      visit(item);
      return limit_m;
    });
  }

 private:
  /// Children are at first and first + 1; a leaf has items first to first + count - 1.
  struct Node {
    Eigen::AlignedBox3d box;
    std::uint32_t first = 0;
    std::uint32_t count = 0;  ///< 0: not a leaf
  };
  // Halving keeps the tree as deep as the logarithm of its size, so this holds for any that fits in memory.
  static constexpr std::size_t kMaxDepth = 64;

  void build(std::uint32_t node, std::uint32_t begin, std::uint32_t end, std::span<const Eigen::AlignedBox3d> boxes);

  /// Depth first, the child with the smaller cost first; what costs more than the limit is left out. A cost of infinity
  /// always is.
  template <class Cost, class Visit>
  void visit_ordered(const Cost& cost, double limit_m, Visit&& visit) const;

  std::vector<Node> nodes_;
  std::vector<Item> items_;
  std::vector<Eigen::AlignedBox3d> item_boxes_;  ///< in the order of items_
};

template <class Cost, class Visit>
void PlaneTree::visit_ordered(const Cost& cost, double limit_m, Visit&& visit) const {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  struct Waiting {
    std::uint32_t node;
    double cost_m;
  };
  if (nodes_.empty()) return;
  std::array<Waiting, kMaxDepth> waiting;
  std::size_t size = 0;
  const auto push = [&](std::uint32_t node, double cost_m) {
    if (cost_m <= limit_m && cost_m < kNever) waiting[size++] = {node, cost_m};
  };
  push(0, cost(nodes_[0].box));
  while (size > 0) {
    const Waiting next = waiting[--size];
    if (next.cost_m > limit_m) continue;
    const Node& node = nodes_[next.node];
    if (node.count == 0) {
      double near_m = cost(nodes_[node.first].box);
      double far_m = cost(nodes_[node.first + 1].box);
      std::uint32_t near = node.first;
      std::uint32_t far = node.first + 1;
      if (far_m < near_m) {
        std::swap(near, far);
        std::swap(near_m, far_m);
      }
      push(far, far_m);
      push(near, near_m);
      continue;
    }
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      const double cost_m = cost(item_boxes_[i]);
      if (cost_m <= limit_m && cost_m < kNever) limit_m = visit(items_[i], limit_m);
    }
  }
}

}  // namespace planemap

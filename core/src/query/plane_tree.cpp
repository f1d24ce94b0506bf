#include "query/plane_tree.hpp"

#include <planemap/query/limits.hpp>

namespace planemap {

namespace {

constexpr std::uint32_t kLeafSize = 4;

/// The box with room for what rounding does, so that surfaces along an axis are not missed.
Eigen::AlignedBox3d with_margin(const Eigen::AlignedBox3d& box) {
  const double farthest_m = std::max(box.min().cwiseAbs().maxCoeff(), box.max().cwiseAbs().maxCoeff());
  const Eigen::Vector3d margin_m = Eigen::Vector3d::Constant(2.0 * kOnBorderM + 1e-14 * farthest_m);
  return {box.min() - margin_m, box.max() + margin_m};
}

}  // namespace

double RayLine::entry_m(const Eigen::AlignedBox3d& box) const {
  double entry_m = 0.0;
  double exit_m = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    const double low_m = box.min()[axis] - origin_m[axis];
    const double high_m = box.max()[axis] - origin_m[axis];
    if (direction[axis] == 0.0) {
      if (low_m > 0.0 || high_m < 0.0) return std::numeric_limits<double>::infinity();
      continue;
    }
    const double a_m = low_m * inverse[axis];
    const double b_m = high_m * inverse[axis];
    entry_m = std::max(entry_m, std::min(a_m, b_m));
    exit_m = std::min(exit_m, std::max(a_m, b_m));
  }
  return entry_m <= exit_m ? entry_m : std::numeric_limits<double>::infinity();
}

PlaneTree::PlaneTree(std::span<const Eigen::AlignedBox3d> boxes) {
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (!boxes[i].isEmpty()) items_.push_back(static_cast<Item>(i));
  }
  if (items_.empty()) return;
  nodes_.emplace_back();
  build(0, 0, static_cast<std::uint32_t>(items_.size()), boxes);
  item_boxes_.reserve(items_.size());
  for (const Item item : items_) item_boxes_.push_back(with_margin(boxes[item]));
}

void PlaneTree::build(std::uint32_t node, std::uint32_t begin, std::uint32_t end,
                      std::span<const Eigen::AlignedBox3d> boxes) {
  Eigen::AlignedBox3d box;
  Eigen::AlignedBox3d centres;
  for (std::uint32_t i = begin; i < end; ++i) {
    box.extend(boxes[items_[i]]);
    centres.extend(boxes[items_[i]].center());
  }
  nodes_[node].box = with_margin(box);
  if (end - begin <= kLeafSize) {
    nodes_[node].first = begin;
    nodes_[node].count = end - begin;
    return;
  }
  Eigen::Index axis = 0;
  centres.sizes().maxCoeff(&axis);
  const std::uint32_t middle = begin + (end - begin) / 2;
  const auto at = [this](std::uint32_t i) { return items_.begin() + static_cast<std::ptrdiff_t>(i); };
  std::nth_element(at(begin), at(middle), at(end), [&](Item a, Item b) {
    const double centre_a = boxes[a].center()[axis];
    const double centre_b = boxes[b].center()[axis];
    return centre_a != centre_b ? centre_a < centre_b : a < b;
  });
  const auto first = static_cast<std::uint32_t>(nodes_.size());
  nodes_[node].first = first;
  nodes_.resize(nodes_.size() + 2);
  build(first, begin, middle, boxes);
  build(first + 1, middle, end, boxes);
}

}  // namespace planemap

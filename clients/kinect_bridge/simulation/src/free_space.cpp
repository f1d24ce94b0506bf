#include "free_space.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <queue>
#include <utility>

namespace planemap::simulation {
namespace {

constexpr double kStepM = 0.05;           // of the raster
constexpr double kNarrownessCost = 0.35;  // metres: a path at this clearance counts twice its length
constexpr std::size_t kNowhere = std::numeric_limits<std::size_t>::max();

}  // namespace

FreeSpace::FreeSpace(const Rectangle& outline, const std::vector<Footprint>& obstacles)
    : outline_(outline),
      obstacles_(obstacles),
      columns_(static_cast<int>(outline.size_m().x() / kStepM) + 1),
      rows_(static_cast<int>(outline.size_m().y() / kStepM) + 1),
      clearance_m_(static_cast<std::size_t>(columns_) * rows_) {
  for (std::size_t i = 0; i < clearance_m_.size(); ++i) {
    clearance_m_[i] = static_cast<float>(clearance_m(point_of(node_of(i))));
  }
}

double FreeSpace::clearance_m(const Eigen::Vector2d& p_m) const {
  double least_m = std::numeric_limits<double>::infinity();
  for (const Footprint& obstacle : obstacles_) least_m = std::min(least_m, obstacle.distance_m(p_m));
  return least_m;
}

FreeSpace::Node FreeSpace::node_at(const Eigen::Vector2d& p_m) const {
  const Eigen::Vector2d steps = (p_m - outline_.min_m) / kStepM;
  return {std::clamp(static_cast<int>(std::lround(steps.x())), 0, columns_ - 1),
          std::clamp(static_cast<int>(std::lround(steps.y())), 0, rows_ - 1)};
}

Eigen::Vector2d FreeSpace::point_of(const Node& node) const {
  return outline_.min_m + kStepM * Eigen::Vector2d(node.x, node.y);
}

std::optional<Eigen::Vector2d> FreeSpace::nearest_free(const Eigen::Vector2d& wish_m, const Rectangle& within,
                                                       double clearance_m) const {
  std::optional<Eigen::Vector2d> nearest_m;
  for (std::size_t i = 0; i < clearance_m_.size(); ++i) {
    const Eigen::Vector2d p_m = point_of(node_of(i));
    if (clearance_m_[i] < clearance_m || !within.contains(p_m, 0.0)) continue;
    if (!nearest_m || (p_m - wish_m).squaredNorm() < (*nearest_m - wish_m).squaredNorm()) nearest_m = p_m;
  }
  return nearest_m;
}

Eigen::Vector2d FreeSpace::roomiest(const Rectangle& within) const {
  Eigen::Vector2d best_m = within.centre_m();
  float best_clearance_m = -1.0F;
  for (std::size_t i = 0; i < clearance_m_.size(); ++i) {
    const Eigen::Vector2d p_m = point_of(node_of(i));
    if (clearance_m_[i] <= best_clearance_m || !within.contains(p_m, 0.0)) continue;
    best_m = p_m;
    best_clearance_m = clearance_m_[i];
  }
  return best_m;
}

std::vector<Eigen::Vector2d> FreeSpace::trace_back(const std::vector<std::size_t>& came_from, std::size_t from,
                                                   std::size_t to) const {
  std::vector<Eigen::Vector2d> points_m;
  for (std::size_t at = to; at != from; at = came_from[at]) points_m.push_back(point_of(node_of(at)));
  points_m.push_back(point_of(node_of(from)));
  std::reverse(points_m.begin(), points_m.end());
  return points_m;
}

std::vector<Eigen::Vector2d> FreeSpace::path(const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m,
                                             double least_clearance_m) const {
  constexpr std::array<std::pair<int, int>, 8> kSteps = {
      {{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {1, -1}, {-1, 1}, {-1, -1}}};
  using Entry = std::pair<double, std::size_t>;  // cost, node
  const std::size_t from = index_of(node_at(from_m));
  const std::size_t to = index_of(node_at(to_m));
  std::vector<double> cost(clearance_m_.size(), std::numeric_limits<double>::infinity());
  std::vector<std::size_t> came_from(clearance_m_.size(), kNowhere);
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  cost[from] = 0.0;
  open.emplace(0.0, from);
  while (!open.empty()) {
    const Entry entry = open.top();
    open.pop();
    const std::size_t at = entry.second;
    if (at == to) return trace_back(came_from, from, to);
    if (entry.first > cost[at]) continue;
    const Node node = node_of(at);
    for (const auto& step : kSteps) {
      const Node next{node.x + step.first, node.y + step.second};
      if (next.x < 0 || next.y < 0 || next.x >= columns_ || next.y >= rows_) continue;
      const std::size_t neighbour = index_of(next);
      const double clearance_m = clearance_m_[neighbour];
      if (clearance_m < least_clearance_m) continue;
      const double length_m = kStepM * std::hypot(step.first, step.second);
      const double new_cost = cost[at] + length_m * (1.0 + std::pow(kNarrownessCost / clearance_m, 2));
      if (new_cost >= cost[neighbour]) continue;
      cost[neighbour] = new_cost;
      came_from[neighbour] = at;
      open.emplace(new_cost, neighbour);
    }
  }
  return {};
}

}  // namespace planemap::simulation

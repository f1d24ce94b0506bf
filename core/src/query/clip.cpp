#include "query/clip.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

namespace planemap {

namespace {

constexpr double kSliverM2 = 1e-12;

/// A piece of a ring between where it comes into the half-plane and where it leaves it.
struct Chain {
  Ring points;  ///< with both crossings
  double enters_at = 0.0;
  double leaves_at = 0.0;  ///< place along the half-plane's border
};

Eigen::Vector2d crossing(const Eigen::Vector2d& a, double excess_a, const Eigen::Vector2d& b, double excess_b) {
  return a + excess_a / (excess_a - excess_b) * (b - a);
}

/// Cuts a ring that crosses the border into chains.
void cut(const Ring& ring, const std::vector<double>& excess, const Eigen::Vector2d& along,
         std::vector<Chain>& chains) {
  const std::size_t n = ring.size();
  std::size_t start = 0;  // a point within, whose predecessor is not
  while (excess[start] > 0.0 || excess[(start + n - 1) % n] <= 0.0) ++start;
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t i = (start + k) % n;
    const std::size_t before = (i + n - 1) % n;
    const bool is_in = excess[i] <= 0.0;
    if (is_in == (excess[before] <= 0.0)) {
      if (is_in) chains.back().points.push_back(ring[i]);
      continue;
    }
    const Eigen::Vector2d on_border = crossing(ring[before], excess[before], ring[i], excess[i]);
    if (is_in) {
      Chain& chain = chains.emplace_back();
      chain.points.reserve(n + 2);
      chain.points.push_back(on_border);
      chain.points.push_back(ring[i]);
      chain.enters_at = along.dot(on_border);
    } else {
      chains.back().points.push_back(on_border);
      chains.back().leaves_at = along.dot(on_border);
    }
  }
}

/// Joins chains along the border into rings. The inside is to the left, so from where a chain leaves the way goes along
/// the border, the half-plane to the left, to the next place where one enters: the first leaving to the first entering
/// place, and so on. Matched by rank, it comes out even where rounding has places change their order.
void join(std::vector<Chain>& chains, std::vector<Ring>& rings) {
  const std::size_t n = chains.size();
  if (n == 1) rings.push_back(std::move(chains.front().points));
  if (n <= 1) return;
  std::vector<std::size_t> leaving(n);
  for (std::size_t i = 0; i < n; ++i) leaving[i] = i;
  std::vector<std::size_t> entering = leaving;
  std::sort(leaving.begin(), leaving.end(),
            [&](std::size_t a, std::size_t b) { return chains[a].leaves_at < chains[b].leaves_at; });
  std::sort(entering.begin(), entering.end(),
            [&](std::size_t a, std::size_t b) { return chains[a].enters_at < chains[b].enters_at; });
  std::vector<std::size_t> next(n);
  for (std::size_t i = 0; i < n; ++i) next[leaving[i]] = entering[i];
  std::vector<bool> used(n, false);
  for (std::size_t first = 0; first < n; ++first) {
    if (used[first]) continue;
    Ring ring;
    for (std::size_t i = first; !used[i]; i = next[i]) {
      used[i] = true;
      ring.insert(ring.end(), chains[i].points.begin(), chains[i].points.end());
    }
    rings.push_back(std::move(ring));
  }
}

bool is_around(const Ring& ring, const Eigen::Vector2d& p_m) {
  bool odd = false;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Eigen::Vector2d& a = ring[i];
    const Eigen::Vector2d& b = ring[(i + 1) % ring.size()];
    if ((a.y() <= p_m.y()) == (b.y() <= p_m.y())) continue;
    odd ^= p_m.x() < a.x() + (p_m.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x());
  }
  return odd;
}

}  // namespace

std::vector<Ring> rings_of(std::span<const Polygon> polygons) {
  std::vector<Ring> rings;
  for (const Polygon& polygon : polygons) {
    rings.push_back(polygon.outer);
    rings.insert(rings.end(), polygon.holes.begin(), polygon.holes.end());
  }
  return rings;
}

bool holds(const HalfPlane& half_plane, const std::vector<Ring>& rings) {
  return std::all_of(rings.begin(), rings.end(), [&](const Ring& ring) {
    return std::all_of(ring.begin(), ring.end(),
                       [&](const Eigen::Vector2d& p_m) { return half_plane.excess(p_m) <= 0.0; });
  });
}

void clip(std::vector<Ring>& rings, const HalfPlane& half_plane) {
  if (holds(half_plane, rings)) return;
  const Eigen::Vector2d along(-half_plane.normal.y(), half_plane.normal.x());
  std::vector<Ring> kept;
  std::vector<Chain> chains;
  std::vector<double> excess;
  for (Ring& ring : rings) {
    excess.clear();
    excess.reserve(ring.size());
    for (const Eigen::Vector2d& p_m : ring) excess.push_back(half_plane.excess(p_m));
    const auto within = std::count_if(excess.begin(), excess.end(), [](double e) { return e <= 0.0; });
    if (within == 0) continue;
    if (within == std::ssize(ring)) {
      kept.push_back(std::move(ring));
    } else {
      cut(ring, excess, along, chains);
    }
  }
  join(chains, kept);
  rings = std::move(kept);
}

std::vector<Polygon> polygons_of(std::vector<Ring> rings) {
  struct Sized {
    double area_m2;
    Polygon polygon;
  };
  std::vector<Sized> outers;
  std::vector<Ring> holes;
  for (Ring& ring : rings) {
    const double area = signed_area_m2(ring);
    if (area > kSliverM2) {
      outers.push_back({area, {std::move(ring), {}}});
    } else if (area < -kSliverM2) {
      holes.push_back(std::move(ring));
    }
  }
  std::stable_sort(outers.begin(), outers.end(), [](const Sized& a, const Sized& b) { return a.area_m2 < b.area_m2; });
  for (Ring& hole : holes) {
    const Eigen::Vector2d inside_m = 0.5 * (hole[0] + hole[1]);
    const auto around = std::find_if(outers.begin(), outers.end(), [&](const Sized& outer) {
      return is_around(outer.polygon.outer, inside_m) && outer.area_m2 > -signed_area_m2(hole);
    });
    if (around != outers.end()) around->polygon.holes.push_back(std::move(hole));
  }
  std::vector<Polygon> polygons;
  polygons.reserve(outers.size());
  std::reverse(outers.begin(), outers.end());
  for (Sized& outer : outers) polygons.push_back(std::move(outer.polygon));
  return polygons;
}

}  // namespace planemap

#include "outline_scoring.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>

namespace planemap::accuracy {

namespace {

constexpr double kPitch_m = SeenSurfaces::kPitch_m;

using Square = std::array<int, 2>;

Eigen::Vector2d middle_m(const Eigen::Vector2i& square) {
  return kPitch_m * (square.cast<double>().array() + 0.5).matrix();
}

struct Segment {
  Eigen::Vector2d a_m;
  Eigen::Vector2d b_m;
};

double distance_m(const Eigen::Vector2d& p_m, const Segment& s) {
  const Eigen::Vector2d along = s.b_m - s.a_m;
  const double length2 = along.squaredNorm();
  const double t = length2 > 0.0 ? std::clamp((p_m - s.a_m).dot(along) / length2, 0.0, 1.0) : 0.0;
  return (s.a_m + t * along - p_m).norm();
}

double distance_m(const Eigen::Vector2d& p_m, const std::vector<Segment>& border) {
  double least_m = std::numeric_limits<double>::infinity();
  for (const Segment& s : border) least_m = std::min(least_m, distance_m(p_m, s));
  return least_m;
}

/// A ring in the surface's own basis.
void append(const Ring& ring, const PlaneBasis& from, const PlaneBasis& to, std::vector<Segment>& border) {
  for (std::size_t i = 0; i < ring.size(); ++i) {
    border.push_back({to.to_plane(from.to_world(ring[i])), to.to_plane(from.to_world(ring[(i + 1) % ring.size()]))});
  }
}

bool is_inside(const Ring& convex, const Eigen::Vector2d& p_m) {
  for (std::size_t i = 0; i < convex.size(); ++i) {
    const Eigen::Vector2d side = convex[(i + 1) % convex.size()] - convex[i];
    const Eigen::Vector2d to = p_m - convex[i];
    if (side.x() * to.y() - side.y() * to.x() < 0.0) return false;
  }
  return true;
}

/// Share of a square that is on the surface: seen squares at its edges hang over.
double share_on(const std::vector<Ring>& pieces, const Eigen::Vector2d& centre_m) {
  constexpr int kSteps = 8;
  int on = 0;
  for (int i = 0; i < kSteps; ++i) {
    for (int j = 0; j < kSteps; ++j) {
      const Eigen::Vector2d p_m = centre_m + kPitch_m * ((Eigen::Vector2d(i, j).array() + 0.5) / kSteps - 0.5).matrix();
      on += std::any_of(pieces.begin(), pieces.end(), [&](const Ring& piece) { return is_inside(piece, p_m); }) ? 1 : 0;
    }
  }
  return static_cast<double>(on) / (kSteps * kSteps);
}

/// Edges of squares that were seen beside ones that were not.
std::vector<Segment> border_of(const std::vector<Eigen::Vector2i>& squares) {
  std::set<Square> seen;
  for (const Eigen::Vector2i& s : squares) seen.insert({s.x(), s.y()});
  std::vector<Segment> border;
  for (const Eigen::Vector2i& s : squares) {
    const Eigen::Vector2d low_m = kPitch_m * s.cast<double>();
    const Eigen::Vector2d u(kPitch_m, 0.0);
    const Eigen::Vector2d v(0.0, kPitch_m);
    if (seen.count({s.x() - 1, s.y()}) == 0) border.push_back({low_m, low_m + v});
    if (seen.count({s.x() + 1, s.y()}) == 0) border.push_back({low_m + u, low_m + u + v});
    if (seen.count({s.x(), s.y() - 1}) == 0) border.push_back({low_m, low_m + u});
    if (seen.count({s.x(), s.y() + 1}) == 0) border.push_back({low_m + v, low_m + v + u});
  }
  return border;
}

/// Fills gaps of up to two squares, a cell: rays are farther apart than squares where a surface was seen from afar, and
/// an outline closes such gaps, too.
std::vector<Eigen::Vector2i> closed(const std::vector<Eigen::Vector2i>& squares) {
  std::set<Square> grown;
  const auto for_each_around = [](const Square& s, const auto& visit) {
    for (int i = -1; i <= 1; ++i) {
      for (int j = -1; j <= 1; ++j) visit(Square{s[0] + i, s[1] + j});
    }
  };
  for (const Eigen::Vector2i& s : squares) {
    for_each_around({s.x(), s.y()}, [&](const Square& at) { grown.insert(at); });
  }
  std::vector<Eigen::Vector2i> result;
  for (const Square& s : grown) {
    bool all = true;
    for_each_around(s, [&](const Square& at) { all = all && grown.count(at) > 0; });
    if (all) result.emplace_back(s[0], s[1]);
  }
  return result;
}

double width_m(const std::vector<Eigen::Vector2i>& squares) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2i& s : squares) mean += s.cast<double>() / static_cast<double>(squares.size());
  Eigen::Matrix2d spread = Eigen::Matrix2d::Identity() / 12.0;  // of a square within itself
  for (const Eigen::Vector2i& s : squares) {
    const Eigen::Vector2d off = s.cast<double>() - mean;
    spread += off * off.transpose() / static_cast<double>(squares.size());
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(spread, Eigen::EigenvaluesOnly);
  return kPitch_m * std::sqrt(12.0 * solver.eigenvalues()(0));
}

/// Whether a point is in the polygons with this border, by the sides that a ray from it crosses.
bool is_within(const std::vector<Segment>& border, const Eigen::Vector2d& p_m) {
  bool within = false;
  for (const Segment& s : border) {
    if ((s.a_m.y() > p_m.y()) == (s.b_m.y() > p_m.y())) continue;
    const double t = (p_m.y() - s.a_m.y()) / (s.b_m.y() - s.a_m.y());
    if (p_m.x() < s.a_m.x() + t * (s.b_m.x() - s.a_m.x())) within = !within;
  }
  return within;
}

/// From a square's middle to that of the nearest of some.
double distance_to_nearest_m(const std::set<Square>& seen, const Eigen::Vector2i& from) {
  if (seen.count({from.x(), from.y()}) > 0) return 0.0;
  int least2 = std::numeric_limits<int>::max();
  for (int reach = 1; reach * reach < least2 && reach < 1000; ++reach) {
    for (int along = -reach; along <= reach; ++along) {
      for (const int side : {-reach, reach}) {
        const bool is_there =
            seen.count({from.x() + side, from.y() + along}) > 0 || seen.count({from.x() + along, from.y() + side}) > 0;
        if (is_there) least2 = std::min(least2, reach * reach + along * along);
      }
    }
  }
  return kPitch_m * std::sqrt(static_cast<double>(least2));
}

std::vector<double> overreach_of(const std::vector<Segment>& outline_border,
                                 const std::vector<Eigen::Vector2i>& squares) {
  std::vector<double> overreach_m;
  if (outline_border.empty()) return overreach_m;
  std::set<Square> seen;
  for (const Eigen::Vector2i& s : squares) seen.insert({s.x(), s.y()});
  Eigen::Vector2d low_m = outline_border.front().a_m;
  Eigen::Vector2d high_m = low_m;
  for (const Segment& s : outline_border) {
    low_m = low_m.cwiseMin(s.a_m);
    high_m = high_m.cwiseMax(s.a_m);
  }
  const Eigen::Vector2i first = (low_m.array() / kPitch_m).floor().cast<int>();
  const Eigen::Vector2i last = (high_m.array() / kPitch_m).floor().cast<int>();
  for (int i = first.x(); i <= last.x(); ++i) {
    for (int j = first.y(); j <= last.y(); ++j) {
      const Eigen::Vector2i square(i, j);
      if (!is_within(outline_border, middle_m(square))) continue;
      overreach_m.push_back(distance_to_nearest_m(seen, square));
    }
  }
  return overreach_m;
}

}  // namespace

std::vector<Eigen::Vector3d> centres_of(const MapSnapshot& map, PlaneId plane) {
  std::vector<Eigen::Vector3d> centres_m;
  map.for_each_cell([&](const CellView& cell) {
    if (cell.plane_id == plane) centres_m.push_back(cell.centre_m);
  });
  return centres_m;
}

OutlineScore score_outline(const Outline& outline, const SeenSurfaces& seen, std::size_t surface) {
  const PlaneBasis& basis = seen.basis(surface);
  std::vector<Ring> pieces;
  for (const simulation::ConvexPiece& piece_m : seen.surfaces()[surface].pieces_m) {
    Ring& ring = pieces.emplace_back();
    for (const Eigen::Vector3d& corner_m : piece_m) ring.push_back(basis.to_plane(corner_m));
  }
  OutlineScore score;
  std::vector<Segment> outline_border;
  for (const Polygon& polygon : outline.polygons) {
    score.outline_m2 += signed_area_m2(polygon.outer);
    append(polygon.outer, outline.basis, basis, outline_border);
    for (const Ring& hole : polygon.holes) {
      score.outline_m2 += signed_area_m2(hole);  // clockwise: negative
      append(hole, outline.basis, basis, outline_border);
    }
  }
  const std::vector<Eigen::Vector2i> open = seen.squares(surface);
  const std::vector<Eigen::Vector2i> squares = closed(open);
  score.seen_width_m = width_m(squares);
  for (const Eigen::Vector2i& s : squares) {
    const double share = share_on(pieces, middle_m(s));
    score.seen_m2 += kPitch_m * kPitch_m * share;
    if (share < 0.5) continue;
    score.shortfall_m.push_back(is_within(outline_border, middle_m(s)) ? 0.0 : distance_m(middle_m(s), outline_border));
  }
  score.overreach_m = overreach_of(outline_border, squares);
  std::vector<Segment> seen_border = border_of(squares);
  for (const Segment& s : border_of(open)) seen_border.push_back(s);
  for (const Segment& s : outline_border) {
    const int steps = 1 + static_cast<int>((s.b_m - s.a_m).norm() / kPitch_m);
    for (int i = 0; i < steps; ++i) {
      score.border_m.push_back(distance_m(Eigen::Vector2d(s.a_m + (s.b_m - s.a_m) * i / steps), seen_border));
    }
  }
  return score;
}

}  // namespace planemap::accuracy

#define BOOST_ALLOW_DEPRECATED_HEADERS  // Boost.Geometry 1.74 includes some of Boost's own, with a message for each.

#include "rtree_nearest.hpp"

#include <algorithm>
#include <boost/geometry/algorithms/distance.hpp>
#include <boost/geometry/geometries/box.hpp>
#include <boost/geometry/geometries/point.hpp>
#include <boost/geometry/index/rtree.hpp>
#include <boost/geometry/strategies/strategies.hpp>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "query/prepared_surface.hpp"

namespace planemap::benchmark {

namespace bg = boost::geometry;
namespace bgi = boost::geometry::index;

class RtreeNearest::Impl {
 public:
  explicit Impl(std::span<const DescribedPlane> planes) : planes_(planes) {
    std::vector<Entry> entries;
    for (const DescribedPlane& plane : planes) {
      const PreparedSurface& surface = surfaces_.emplace_back(*plane.outline);
      if (!surface.empty())
        entries.emplace_back(Box(of(surface.box().min()), of(surface.box().max())), surfaces_.size() - 1);
    }
    tree_ = Tree(entries);  // packed
  }

  PlaneId nearest(const Eigen::Vector3d& p_world_m) const {
    Best best;
    // The tree keeps a sorted list of as many boxes as it is asked for, so it is asked for few first.
    for (std::size_t count = 32; !look(p_world_m, std::min(count, planes_.size()), best); count *= 8) best = {};
    return best.id;
  }

 private:
  struct Best {
    double distance_m = std::numeric_limits<double>::infinity();
    PlaneId id = kNoPlane;
  };
  /// One after the other by their boxes, until the next box is farther than the best surface.
  /// @return whether none of the boxes that were not looked at can hold a nearer one
  bool look(const Eigen::Vector3d& p_world_m, std::size_t count, Best& best) const {
    const Point point = of(p_world_m);
    for (auto it = tree_.qbegin(bgi::nearest(point, static_cast<unsigned>(count))); it != tree_.qend(); ++it) {
      if (bg::distance(point, it->first) > best.distance_m) return true;
      const double off_m = planes_[it->second].record->plane.signed_distance_m(p_world_m);
      if (std::abs(off_m) >= best.distance_m) continue;
      const PreparedSurface& surface = surfaces_[it->second];
      const double distance_m = std::hypot(off_m, surface.spot(surface.basis().to_plane(p_world_m)).distance_m);
      if (distance_m < best.distance_m) best = {distance_m, planes_[it->second].record->id};
    }
    return count == planes_.size();
  }

  using Point = bg::model::point<double, 3, bg::cs::cartesian>;
  using Box = bg::model::box<Point>;
  using Entry = std::pair<Box, std::size_t>;
  using Tree = bgi::rtree<Entry, bgi::rstar<16>>;

  static Point of(const Eigen::Vector3d& p) { return {p.x(), p.y(), p.z()}; }

  std::span<const DescribedPlane> planes_;
  std::vector<PreparedSurface> surfaces_;
  Tree tree_;
};

RtreeNearest::RtreeNearest(std::span<const DescribedPlane> planes) : impl_(std::make_unique<Impl>(planes)) {}
RtreeNearest::~RtreeNearest() = default;

PlaneId RtreeNearest::nearest(const Eigen::Vector3d& p_world_m) const {
  return impl_->nearest(p_world_m);
}

}  // namespace planemap::benchmark

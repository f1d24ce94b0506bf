#pragma once

#include <cstdint>
#include <planemap/client/map_types.hpp>
#include <planemap/client/map_watch.hpp>
#include <vector>

namespace planemap::client {

/// What changed from one revision to another of one epoch.
struct Delta {
  std::int64_t epoch = 0;
  std::int64_t since_revision = 0;  ///< 0: the planes are all there are
  std::int64_t revision = 0;
  std::string frame;
  std::vector<Plane> planes;  ///< new and changed
  std::vector<RemovedPlane> removed;
};

/// A copy of a map, and what each piece of news changes in it.
class MapMirror {
 public:
  bool has_map() const { return has_map_; }
  const Map& map() const { return map_; }

  /// What there is to say where there is no news.
  MapChange no_change() const;
  /// Takes the whole map instead.
  MapChange replace(Map map);
  /// Whether news say more than is known, and connect to it.
  bool fits(const Delta& delta) const;
  /// @pre fits(delta)
  MapChange apply(Delta delta);

 private:
  bool has_map_ = false;
  Map map_;  ///< planes by id
};

}  // namespace planemap::client

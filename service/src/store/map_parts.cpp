#include "store/map_parts.hpp"

#include <planemap/map_check.hpp>

namespace planemap::service {

FactRows read_facts(Database& database) {
  FactRows facts;
  Statement rows = database.prepare("SELECT key, value FROM meta");
  while (rows.step()) facts[rows.text(0)] = rows.text(1);
  return facts;
}

void take_facts(const FactRows& rows, StoredMap& map, MapSnapshot::Parts& parts) {
  const Facts facts(rows);
  map.format = facts.whole<int>("format");
  map.facts = {facts.text("frame"), facts.text("gravity"), facts.text("config"), facts.text("version")};
  map.reserved_ids = facts.whole<PlaneId>("reserved_ids");
  map.reserved_revisions = facts.whole<std::uint64_t>("reserved_revisions");
  map.closed = facts.text("closed") == "1";
  parts.epoch = facts.whole<std::uint64_t>("epoch");
  parts.revision = facts.whole<std::uint64_t>("revision");
  parts.utime = facts.whole<std::int64_t>("utime");
  parts.cell_size_m = facts.real("cell_size_m");
  parts.density_threshold = facts.whole<int>("density_threshold");
  parts.removed_complete_since = facts.whole<std::uint64_t>("removed_complete_since");
  parts.state.next_plane_id = facts.whole<PlaneId>("next_plane_id");
  parts.state.poses_err = facts.text("poses_err") == "1";
  parts.state.pose_variance_m2 = facts.real("pose_variance_m2");
  parts.state.scans = facts.whole<std::int64_t>("scans");
  const char* rest = facts.text("last_pose").c_str();
  for (Eigen::Index i = 0; i < 36; ++i) {
    char* end = nullptr;
    parts.state.last_pose.data()[i] = std::strtod(rest, &end);
    if (end == rest) throw Damage("meta: last_pose has too few numbers");
    rest = end;
  }
}

Expected<void> check_stored(const MapSnapshot& map) {
  MapperConfig config;  // whose cells are right in any case
  config.grid.cell_size_m = map.cell_size_m();
  return check_map(config, map);
}

}  // namespace planemap::service

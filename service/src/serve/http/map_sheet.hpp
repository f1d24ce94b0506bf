#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <planemap/query/snapshot_queries.hpp>
#include <string>
#include <vector>

namespace planemap::service {

/// A snapshot as browsers are told of it. Made from the sheet before: the text of a plane that has not changed is kept.
/// Immutable: any number of threads may read it.
class MapSheet {
 public:
  /// @param queries   of the snapshot
  /// @param frame     name of the world frame
  /// @param previous  of an earlier snapshot, or nullptr. Not kept.
  MapSheet(std::shared_ptr<const SnapshotQueries> queries, std::string frame, const MapSheet* previous);

  const SnapshotQueries& queries() const { return *queries_; }
  const MapSnapshot& snapshot() const { return queries_->snapshot(); }
  const std::string& frame() const { return frame_; }
  /// "EPOCH-REVISION", in quotes.
  std::string etag() const;

  /// planes.json, with the deviations of each plane beside it.
  std::string planes_document() const;
  /// One plane of it; nullptr: there is none of that id.
  const std::string* plane_json(PlaneId id) const;
  /// What brings a reader of this epoch from a revision to this sheet, as the JSON of a delta event: whole planes, ids
  /// that are no more, and how many blocks of cells have changed.
  /// @param since  revision of the reader's sheet; empty: it has none, or of another epoch. The delta is full, too,
  ///               where it is not known any more what has changed since.
  std::shared_ptr<const std::string> delta_json(std::optional<std::uint64_t> since) const;
  /// For each block of the snapshot: the revision since which its cells are as they are, or a later one. Whoever has
  /// the blocks of a sheet of revision R needs those with a greater one.
  const std::vector<std::uint64_t>& block_revisions() const { return block_revisions_; }
  /// Of no other sheet of this process.
  std::uint64_t serial() const { return serial_; }
  /// Whether some block has changed since a sheet of that revision.
  bool has_cells_beyond(std::uint64_t revision) const { return newest_block_revision_ > revision; }
  /// Changes since an earlier revision than this are not known.
  std::uint64_t complete_since() const { return complete_since_; }

 private:
  struct Plane {
    std::shared_ptr<const PlaneRecord> record;
    std::shared_ptr<const Outline> outline;
    PlaneClass plane_class = PlaneClass::kOther;
    std::vector<PlaneId> coplanar;
    std::shared_ptr<const std::string> json;
    std::uint64_t changed_revision = 0;
  };

  std::uint64_t revision_of_change(const MapSheet* previous) const;
  void add_planes(const MapSheet* previous);
  void add_blocks(const MapSheet* previous);
  std::string make_delta(std::optional<std::uint64_t> since) const;

  const std::shared_ptr<const SnapshotQueries> queries_;
  const std::string frame_;
  const std::uint64_t serial_;
  std::uint64_t complete_since_ = 0;
  std::vector<Plane> planes_;  ///< by id
  std::vector<std::uint64_t> block_revisions_;
  std::uint64_t newest_block_revision_ = 0;

  mutable std::mutex mutex_;  ///< of what follows
  /// Those that were asked for, so that readers share them.
  mutable std::map<std::optional<std::uint64_t>, std::shared_ptr<const std::string>> deltas_;
};

}  // namespace planemap::service

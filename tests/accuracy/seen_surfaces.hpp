#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <planemap/outline.hpp>
#include <planemap/simulation/simulated_source.hpp>
#include <planemap/simulation/surface.hpp>
#include <unordered_map>
#include <vector>

namespace planemap::accuracy {

/// Which parts of the true surfaces a recording saw: squares of a raster on each surface.
class SeenSurfaces {
 public:
  static constexpr double kPitch_m = 0.04;  ///< edge of a square

  /// @param max_range_m  returns from farther are not mapped, so they don't count as seen
  SeenSurfaces(const std::vector<simulation::Surface>& surfaces, double max_range_m);

  /// Marks what the frame that the source gave last has returns from.
  void add(const simulation::SimulatedSource& source, const DepthScan& scan);

  struct Patch {
    std::size_t surface;       ///< place in surfaces()
    Eigen::Vector3d centre_m;  ///< world frame
    double area_m2;            ///< of the square; less on facets, which are narrower than it
  };
  /// All squares that were seen, surface by surface, in an order that depends on the recording alone.
  std::vector<Patch> patches() const;
  const std::vector<simulation::Surface>& surfaces() const { return surfaces_; }
  /// The basis of a surface's raster.
  const PlaneBasis& basis(std::size_t surface) const { return bases_[surface]; }
  /// The squares of a surface that were seen, ordered: each from kPitch_m times its two numbers on, in the basis.
  std::vector<Eigen::Vector2i> squares(std::size_t surface) const;
  /// How much of a surface was seen, square metres.
  double seen_m2(std::size_t surface) const;
  /// In how many frames a surface had a return.
  std::size_t frames(std::size_t surface) const { return frames_[surface]; }
  /// Whether all squares of a surface that come within a distance of a point were seen.
  bool all_seen_about(std::size_t surface, const Eigen::Vector3d& p_world_m, double distance_m) const;

 private:
  std::vector<simulation::Surface> surfaces_;
  std::vector<PlaneBasis> bases_;
  double max_range_m_;
  std::vector<std::unordered_map<std::uint64_t, std::uint32_t>> hits_;  // by surface, then square
  std::vector<std::size_t> frames_;                                     // by surface
};

}  // namespace planemap::accuracy

#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <planemap/simulation/surface.hpp>
#include <span>
#include <vector>

#include "walk.hpp"
#include "wing.hpp"

namespace planemap::simulation {

/// Corridors and rooms without end. Wings are made when the camera comes near them and forgotten behind it, so what it
/// takes does not grow with what was seen, but for a bit for each piece of a surface.
class Building {
 public:
  /// @param sight_m  how far the camera sees
  Building(std::uint64_t seed, double sight_m);

  /// Where the camera is after some time; time must not go back by more than a second.
  Eigen::Isometry3d T_world_sensor(double time_s);
  /// How the building lies in the world.
  const Eigen::Isometry3d& T_world_building() const { return T_world_building_; }

  /// The pieces of surfaces that can be seen from there, each as a surface of its own; empty: the same as last time.
  std::optional<std::vector<Surface>> look_from(const Eigen::Vector3d& p_world_m);
  /// Notes what was seen, and turns the names of the pieces into those of their surfaces.
  void name(std::span<SurfaceId> labels);

  /// How many wings it keeps.
  std::size_t kept_wings() const { return parts_.size(); }

  /// What was seen of the surfaces so far, by id, with gaps. Floor and ceiling are one surface through all wings. Makes
  /// the wings anew, so it takes a while.
  std::vector<Surface> seen() const;

 private:
  /// A wing with its surfaces, names already those of the building.
  struct Part {
    std::vector<Surface> surfaces;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> pieces;  // surface and its piece, by the piece's number
  };
  Part make_part(std::size_t number) const;
  const Part& part(std::size_t number);

  std::uint64_t seed_;
  double sight_m_;
  Eigen::Isometry3d T_world_building_;
  Walk walk_;
  std::map<std::size_t, Part> parts_;             // by the wing's number; those near the camera
  std::optional<Eigen::Vector3d> looked_from_m_;  // world frame
  std::vector<std::vector<bool>> seen_;           // by wing and number of the piece
};

}  // namespace planemap::simulation

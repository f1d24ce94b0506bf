#pragma once

#include <cstddef>
#include <map>
#include <planemap/snapshot.hpp>
#include <vector>

#include "picture/plane_picture.hpp"
#include "real/ransac_planes.hpp"

namespace planemap::experiments {

/// The planes of a map as faces, largest area first, coloured by rank.
struct MapFaces {
  std::vector<PictureFace> faces;
  std::vector<PlaneId> ids;  ///< by face
};
MapFaces faces_of(const MapSnapshot& map, double least_area_m2);

/// The planes of RANSAC as faces, coloured by rank.
/// @param sensors_m  from where they were seen
std::vector<PictureFace> faces_of(const std::vector<RansacPlane>& planes, const std::vector<Eigen::Vector3f>& cloud_m,
                                  const std::vector<Eigen::Vector3d>& sensors_m, double cell_size_m);

}  // namespace planemap::experiments

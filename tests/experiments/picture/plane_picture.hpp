#pragma once

#include <Eigen/Core>
#include <planemap/outline.hpp>
#include <planemap/plane.hpp>
#include <string>
#include <vector>

#include "picture/camera.hpp"
#include "plot/svg_page.hpp"

namespace planemap::experiments {

/// 0 to 255 each.
struct Rgb {
  int red = 0;
  int green = 0;
  int blue = 0;
};
/// Colours that are easily told apart, for planes by rank; they repeat after sixteen.
Rgb colour_of_rank(std::size_t rank);

/// One plane in a picture.
struct PictureFace {
  Plane plane;  ///< the normal towards the side from which it is seen
  Outline outline;
  Rgb colour;
};

/// The azimuth from which most of the faces' area turns to the viewer, radians.
double best_azimuth_rad(const Eigen::Vector3d& up, double elevation_rad, const std::vector<PictureFace>& faces);

/// Draws what faces the viewer, back to front; faces that turn away are left out, so one looks into rooms.
void draw_faces(plot::SvgPage& page, const PageFit& place, const Camera& camera, const std::vector<PictureFace>& faces);

/// All corners of the faces, world frame.
std::vector<Eigen::Vector3d> corners_of(const std::vector<PictureFace>& faces);

/// Places in `faces`, such that who is drawn later hides who is behind it.
std::vector<std::size_t> back_to_front(const Camera& camera, const std::vector<PictureFace>& faces);

}  // namespace planemap::experiments

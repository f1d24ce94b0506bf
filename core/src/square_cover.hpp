#pragma once

#include <array>
#include <span>
#include <vector>

namespace planemap {

/// Axis-aligned, in raster steps.
struct RasterRectangle {
  int left;
  int bottom;
  int right;
  int top;
};

/// Rectangles whose union is that of the squares of side 2 half_size about the centres. Inside a densely covered area
/// there is one rectangle to each row instead of a square to each centre, so that the union costs by the length of the
/// border instead of by the area.
/// @param centres  raster steps; any order, duplicates allowed
std::vector<RasterRectangle> square_cover(std::span<const std::array<int, 2>> centres, int half_size);

/// The bins of a raster that hold a point, as one rectangle to each unbroken row of them.
/// @param points  raster steps
std::vector<RasterRectangle> occupied_rows(std::span<const std::array<int, 2>> points, int bin_size);

}  // namespace planemap

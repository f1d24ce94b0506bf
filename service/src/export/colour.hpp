#pragma once

#include <cstdint>
#include <planemap/plane.hpp>
#include <string>

namespace planemap {

/// 0 to 255 each.
struct Colour {
  std::uint8_t red = 0;
  std::uint8_t green = 0;
  std::uint8_t blue = 0;

  std::string hex() const;  ///< "#rrggbb"
};

/// The colour of a plane: depends on its id alone, so a plane keeps it from export to export; ids next to each other
/// get hues far apart.
/// @param lightness  0 black to 1 white
Colour colour_of(PlaneId id, double lightness = 0.45);

}  // namespace planemap

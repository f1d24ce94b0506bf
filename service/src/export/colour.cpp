#include "export/colour.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

namespace planemap {

std::string Colour::hex() const {
  return fmt::format("#{:02x}{:02x}{:02x}", red, green, blue);
}

Colour colour_of(PlaneId id, double lightness) {
  // Steps of the golden angle never repeat a hue and fill the circle evenly.
  const double hue = std::fmod(static_cast<double>(id) * 0.6180339887498949, 1.0) * 12.0;
  const double saturation = 0.62;
  const double chroma = saturation * std::min(lightness, 1.0 - lightness);
  const auto channel = [&](double offset) {  // HSL to RGB
    const double k = std::fmod(offset + hue, 12.0);
    const double value = lightness - chroma * std::max(-1.0, std::min({k - 3.0, 9.0 - k, 1.0}));
    return static_cast<std::uint8_t>(std::lround(255.0 * value));
  };
  return {channel(0.0), channel(8.0), channel(4.0)};
}

}  // namespace planemap

#pragma once

#include <numbers>

namespace planemap {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;

}  // namespace planemap

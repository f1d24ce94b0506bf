#pragma once

#include <span>

namespace planemap::system_test {

/// Something that was looked at.
struct Reading {
  double at_s = 0.0;
  double value = 0.0;
};

/// By how much the value grows in a second: the slope of the straight line of least squares through the readings.
/// Throws std::invalid_argument unless they are of at least two times.
double slope_per_s(std::span<const Reading> readings);

}  // namespace planemap::system_test

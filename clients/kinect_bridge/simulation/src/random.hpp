#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

namespace planemap::simulation {

/// SplitMix64's mixing step (Steele, Lea and Flood, OOPSLA 2014): a well mixed number for each number.
constexpr std::uint64_t mix(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15U;
  x = (x ^ (x >> 30U)) * 0xbf58476d1ce4e5b9U;
  x = (x ^ (x >> 27U)) * 0x94d049bb133111ebU;
  return x ^ (x >> 31U);
}

/// A stream of random numbers. Not std's: its distributions differ between libraries, and a seed is to mean one
/// apartment.
class Random {
 public:
  /// @param stream  streams of one seed are independent of each other
  explicit Random(std::uint64_t seed, std::uint64_t stream = 0) : state_(mix(mix(seed) ^ mix(~stream))) {}

  std::uint64_t bits() {
    state_ += 0x9e3779b97f4a7c15U;
    return mix(state_);
  }
  /// In [low, high).
  double uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(bits() >> 11U) * 0x1.0p-53);
  }
  /// From low to high, both included.
  int integer(int low, int high) { return low + static_cast<int>(bits() % static_cast<std::uint64_t>(high - low + 1)); }
  bool chance(double probability) { return uniform(0.0, 1.0) < probability; }
  /// Mean 0, variance 1 (Box and Muller).
  double gaussian() {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform(0.0, 1.0)));
    return radius * std::cos(uniform(0.0, 2.0 * std::numbers::pi));
  }

 private:
  std::uint64_t state_;
};

}  // namespace planemap::simulation

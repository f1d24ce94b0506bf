#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "contestant.hpp"

namespace planemap::benchmark {

/// Times of all frames by part, in the order in which parts were first seen.
class BenchReport {
 public:
  void add(const PartTimes& times);

  double median_ms(const std::string& part) const { return quantile_ms(part, 0.5); }
  double p95_ms(const std::string& part) const { return quantile_ms(part, 0.95); }

  /// For people: a row a part, with the ratio to the reference and to PCL's VoxelGrid.
  std::string table() const;
  /// {"medianMs": {...}, "p95Ms": {...}, "ratios": {...}, "frames": n, "points": n, "machine": {...}}
  std::string json(std::size_t frames, std::size_t points) const;

 private:
  struct Part {
    std::string name;
    std::vector<double> ms;
  };
  const Part* find(const std::string& name) const;
  double quantile_ms(const std::string& part, double q) const;

  std::vector<Part> parts_;
};

/// The processor, the compiler with its flags, and the libraries' versions.
struct Machine {
  std::string cpu;
  std::string compiler;
  std::string flags;
  std::string pcl;
  std::string octomap;
};
Machine this_machine();

}  // namespace planemap::benchmark

#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "common/quantile.hpp"
#include "contestant.hpp"

namespace planemap::benchmark {

/// Times of all frames by part, in the order in which parts were first seen.
class BenchReport {
 public:
  void add(const PartTimes& times);

  std::vector<std::string> parts() const;  ///< their names
  // Throw std::invalid_argument where there is no such part.
  double median_ms(const std::string& name) const { return median(part(name).ms); }
  double p95_ms(const std::string& name) const { return quantile(part(name).ms, 0.95); }
  double own_median_ms(const std::string& name) const { return median(part(name).own_ms); }

  /// For people: a row a part, with the ratio to the reference and to PCL's VoxelGrid, by own times.
  std::string table() const;
  /// What planemap is to keep below, as far as the parts for it were measured.
  struct Bound {
    const char* name;   ///< in the JSON
    const char* words;  ///< for people
    double ratio;       ///< of medians
    double own_ratio;   ///< the same of the thread's own times, which a busy machine changes less
    double most;
    double aim;
  };
  std::vector<Bound> bounds() const;
  std::string bounds_table() const;
  /// {"medianMs": {...}, "p95Ms": {...}, "ownMedianMs": {...}, "ratios": {...}, "ownRatios": {...}, "frames": n,
  /// "pointsPerFrame": n, "machine": {...}, "versions": {...}}
  std::string json(std::size_t frames, std::size_t points) const;

 private:
  struct Part {
    std::string name;
    std::vector<double> ms;
    std::vector<double> own_ms;
  };
  const Part* find(const std::string& name) const;
  const Part& part(const std::string& name) const;

  std::vector<Part> parts_;
};

struct Versions {
  std::string planemap;
  std::string pcl;
  std::string octomap;
};
Versions library_versions();

}  // namespace planemap::benchmark

#include "soak/trend.hpp"

#include <stdexcept>

namespace planemap::system_test {

double slope_per_s(std::span<const Reading> readings) {
  double mean_s = 0.0;
  double mean_value = 0.0;
  for (const Reading& reading : readings) {
    mean_s += reading.at_s / static_cast<double>(readings.size());
    mean_value += reading.value / static_cast<double>(readings.size());
  }
  double squares = 0.0;
  double products = 0.0;
  for (const Reading& reading : readings) {
    squares += (reading.at_s - mean_s) * (reading.at_s - mean_s);
    products += (reading.at_s - mean_s) * (reading.value - mean_value);
  }
  if (!(squares > 0.0)) throw std::invalid_argument("a trend needs readings of at least two times");
  return products / squares;
}

}  // namespace planemap::system_test

#include "deadline.hpp"

#include <cstdio>

namespace planemap::client {

std::string seconds_text(std::chrono::milliseconds time) {
  char text[32];
  std::snprintf(text, sizeof text, "%g s", static_cast<double>(time.count()) / 1000.0);
  return text;
}

}  // namespace planemap::client

#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace planemap::benchmark {

/// What figures depend on besides the code.
struct Machine {
  std::string cpu;
  unsigned cores = 0;
  double load = 0.0;  ///< mean number of running threads in the last minute; more than a core's worth: times are long
  std::string compiler;
  std::string flags;  ///< of the compiler
  std::string build;  ///< CMake's build type
};
Machine this_machine();

/// One line for people.
std::string text_of(const Machine& machine);
nlohmann::ordered_json json_of(const Machine& machine);

}  // namespace planemap::benchmark

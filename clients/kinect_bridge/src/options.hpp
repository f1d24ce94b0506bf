#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <planemap/simulation/simulated_source.hpp>
#include <planemap/sources/open_folder.hpp>
#include <string>

#include "feed.hpp"

namespace planemap::kinect_bridge {

/// What the command line asks for.
struct Options {
  std::string dataset;  ///< folder; empty: simulate
  sources::FolderOptions folder;
  simulation::SimulationConfig simulation;
  FeedOptions feed;
  bool loop = false;
  std::string truth_path;  ///< empty: none
  std::string log_path;    ///< empty: publish over LCM
  std::string lcm_url;
  bool quiet = false;
  bool json = false;
};

/// The options, or the exit code with which the program ends at once: 0 after --help and --version, 2 after wrong use.
struct ParsedOptions {
  std::optional<Options> options;
  int exit_code = 0;
};
ParsedOptions parse_options(int argc, char** argv);

}  // namespace planemap::kinect_bridge

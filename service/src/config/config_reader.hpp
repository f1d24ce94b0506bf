#pragma once

#include <string>

#include "config/config_problems.hpp"
#include "config/service_config.hpp"

namespace planemap::service {

/// Applies one YAML document to the configuration; keys that are not in it stay as they are.
/// @param name  of the file, for the problems
void apply_yaml(const std::string& text, const std::string& name, ServiceConfig& config, ConfigProblems& problems);

/// Applies "section.key=value"; elements of lists are named by number (inputs.0.channel=SCAN).
void apply_override(const std::string& assignment, ServiceConfig& config, ConfigProblems& problems);

/// What only several settings together can show (ranges, lengths of vectors, channels that collide). Unit vectors and
/// quaternions are normalised.
void check_config(ServiceConfig& config, ConfigProblems& problems);

}  // namespace planemap::service

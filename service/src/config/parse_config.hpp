#pragma once

#include <planemap/expected.hpp>
#include <string>

#include "config/service_config.hpp"

namespace planemap::service {

/// A configuration that is at hand as YAML, for instance that of a map file; keys that are not in it have their
/// defaults. The error lists every problem, one a line.
/// @param name  where it is from, for the problems
Expected<ServiceConfig> parse_config(const std::string& yaml, const std::string& name);

}  // namespace planemap::service

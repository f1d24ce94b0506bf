#pragma once

#include <planemap_lcm/status_t.hpp>
#include <string>

namespace planemap::service {

/// As planemap status --json prints it, on one line.
std::string status_json(const planemap_lcm::status_t& status);

}  // namespace planemap::service

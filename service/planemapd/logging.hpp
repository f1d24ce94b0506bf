#pragma once

#include "config/service_config.hpp"

namespace planemap::service {

/// Sends the log to standard error, as text or as one JSON object a line: {"time", "level", "message"}.
void set_up_logging(const LogConfig& config);

}  // namespace planemap::service

#pragma once

namespace planemap::service {

/// The version that is told to clients and by --version.
const char* version();

}  // namespace planemap::service

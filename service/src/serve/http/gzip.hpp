#pragma once

#include <string>

namespace planemap::service {

/// Compressed as HTTP's coding gzip; empty where zlib has no memory.
/// @param level  of zlib's, 1 to 9
std::string gzip(const std::string& text, int level);

}  // namespace planemap::service

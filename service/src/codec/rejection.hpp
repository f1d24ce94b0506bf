#pragma once

#include <planemap/expected.hpp>
#include <string>
#include <utility>

namespace planemap::service {

/// Why a message could not be used: a word for the counter and a sentence for the log.
struct Rejection {
  std::string reason;   ///< unknown_type, truncated, size, checksum, ...
  std::string message;  ///< what and where, with numbers
};

template <class T>
using Decoded = tl::expected<T, Rejection>;

inline tl::unexpected<Rejection> reject(const char* reason, std::string message) {
  return tl::make_unexpected(Rejection{reason, std::move(message)});
}

}  // namespace planemap::service

#pragma once

#include <limits>
#include <utility>

namespace planemap {

/// What a person needs to know of one setting. The struct that owns the setting lists it in visit_fields().
struct FieldInfo {
  const char* key;                                        ///< name in the configuration file; ends with its unit
  const char* help;                                       ///< one sentence; no full stop
  double min = -std::numeric_limits<double>::infinity();  ///< least value, for numbers
  double max = std::numeric_limits<double>::infinity();   ///< greatest value, for numbers
};

/// One of the words that an enumeration is written as.
template <class E>
using Choice = std::pair<const char*, E>;

}  // namespace planemap

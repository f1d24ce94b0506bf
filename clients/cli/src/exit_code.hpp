#pragma once

namespace planemap::cli {

/// What the program ends with.
enum class ExitCode : int {
  kDone = 0,
  kFailed = 1,
  kWrongUse = 2,     ///< arguments or configuration
  kUnreachable = 3,  ///< no daemon answered, or there is no way to it
};

}  // namespace planemap::cli

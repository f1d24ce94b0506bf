#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <limits>

namespace planemap::cli {

// Checks of what an option is given. CLI11's own take 2^63 for 2^63 - 1 without a word, and tell the limits of a
// double.

/// A whole number within limits.
CLI::Validator whole_number(std::int64_t low, std::int64_t high = std::numeric_limits<std::int64_t>::max());
/// A number, finite and greater than 0.
CLI::Validator positive_number();
/// A number, finite and at least 0.
CLI::Validator not_negative_number();
/// A number that is none of "nan".
/// @param finite  infinite ones are refused, too
CLI::Validator coordinate(bool finite = true);

}  // namespace planemap::cli

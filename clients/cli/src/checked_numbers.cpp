#include "checked_numbers.hpp"

#include <charconv>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <string>

namespace planemap::cli {
namespace {

std::optional<double> number_in(const std::string& text) {
  char* end = nullptr;
  const double number = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0') return std::nullopt;
  return number;
}

/// @param what  of the number, which must hold
template <class Holds>
CLI::Validator number_that(const std::string& what, const Holds& holds) {
  return {[=](std::string& text) -> std::string {
            const auto number = number_in(text);
            if (!number) return "'" + text + "' is no number";
            return holds(*number) ? std::string() : "must be " + what + ", is " + text;
          },
          ""};
}

}  // namespace

CLI::Validator whole_number(std::int64_t low, std::int64_t high) {
  return {[=](std::string& text) -> std::string {
            const bool has_sign = text.size() > 1 && text.front() == '+';
            const char* const begin = text.data() + (has_sign ? 1 : 0);
            const char* const end = text.data() + text.size();
            std::int64_t number = 0;
            const auto [after, error] = std::from_chars(begin, end, number);
            if (error == std::errc() && after == end && number >= low && number <= high) return {};
            return "must be a whole number from " + std::to_string(low) + " to " + std::to_string(high) + ", is '" +
                   text + "'";
          },
          ""};
}

CLI::Validator positive_number() {
  return number_that("greater than 0 and finite", [](double number) { return number > 0.0 && std::isfinite(number); });
}

CLI::Validator not_negative_number() {
  return number_that("at least 0 and finite", [](double number) { return number >= 0.0 && std::isfinite(number); });
}

CLI::Validator coordinate(bool finite) {
  return finite ? number_that("a finite number", [](double number) { return std::isfinite(number); })
                : number_that("a number or infinite", [](double number) { return !std::isnan(number); });
}

}  // namespace planemap::cli

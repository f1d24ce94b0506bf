#include "config/config_problems.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <numeric>

namespace planemap::service {
namespace {

/// Least number of letters to insert, remove or replace.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t above = row[j];
      row[j] = std::min({above + 1, row[j - 1] + 1, diagonal + (a[i - 1] == b[j - 1] ? 0 : 1)});
      diagonal = above;
    }
  }
  return row[b.size()];
}

}  // namespace

void ConfigProblems::add(const std::string& key, const std::string& what, const std::string& place) {
  const std::string where = place.empty() ? place_of(key) : place;
  lines_.push_back(fmt::format("{}{}{}: {}", where, where.empty() ? "" : ": ", key, what));
}

std::string ConfigProblems::place_of(std::string key) const {
  while (!key.empty()) {
    if (const auto found = places_.find(key); found != places_.end()) return found->second;
    const auto dot = key.rfind('.');
    key.resize(dot == std::string::npos ? 0 : dot);
  }
  return {};
}

std::string ConfigProblems::text() const {
  return fmt::format("{}", fmt::join(lines_, "\n"));
}

std::string nearest_word(std::string_view word, const std::vector<std::string>& words) {
  if (word.size() > 64) return {};  // nobody's slip, and the distance costs the product of the lengths
  std::string best;
  std::size_t best_distance = std::max<std::size_t>(2, (word.size() + 2) / 3) + 1;
  for (const auto& candidate : words) {
    // A unit that was left out (cell_size for cell_size_m) is a slip, too.
    const bool is_stem = word.size() >= 3 && candidate.rfind(word, 0) == 0;
    const std::size_t distance = is_stem ? 1 : edit_distance(word, candidate);
    if (distance < best_distance) {
      best = candidate;
      best_distance = distance;
    }
  }
  return best;
}

}  // namespace planemap::service

#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace planemap::service {

/// What is wrong with a configuration, with the place where each key was given.
class ConfigProblems {
 public:
  /// Remembers where a key was given ("planemapd.yaml:12", "--set grid.cell_size_m=1"), for checks that come later.
  void note_place(const std::string& key, const std::string& place) { places_[key] = place; }
  /// @param place  empty: where the key, or else the nearest key above it, was given
  void add(const std::string& key, const std::string& what, const std::string& place = {});

  bool empty() const { return lines_.empty(); }
  std::string text() const;  ///< one problem a line

 private:
  std::string place_of(std::string key) const;

  std::map<std::string, std::string> places_;
  std::vector<std::string> lines_;
};

/// The word that is meant, if one is near enough to be a slip of the fingers; else empty.
std::string nearest_word(std::string_view word, const std::vector<std::string>& words);

}  // namespace planemap::service

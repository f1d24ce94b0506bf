#pragma once

#include <cstdint>
#include <filesystem>
#include <planemap/expected.hpp>
#include <string_view>

namespace planemap::cli {

/// Names an offline map: the same input and settings give the same number, other ones another. 1 to 2^52 - 1.
/// @param input     a log, or a folder: its depth images and text files count, by their names in it and their contents
/// @param settings  all that shapes the map besides
Expected<std::uint64_t> epoch_of(const std::filesystem::path& input, std::string_view settings);
/// The same of what a text tells in full.
std::uint64_t epoch_of(std::string_view text);

}  // namespace planemap::cli

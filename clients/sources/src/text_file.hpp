#pragma once

#include <filesystem>
#include <optional>
#include <planemap/expected.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace planemap::sources {

/// A whole text file of at most 64 MiB.
Expected<std::string> read_text_file(const std::filesystem::path& path);

/// The lines of a text; the last one need not be ended.
std::vector<std::string_view> split_lines(std::string_view text);

/// The words of a line, separated by blanks, tabs or carriage returns.
std::vector<std::string_view> split_words(std::string_view line);

/// A finite number, if the whole word is one.
std::optional<double> parse_number(std::string_view word);

/// Every number of a text; empty if one of its words is no finite number.
std::optional<std::vector<double>> parse_numbers(std::string_view text);

}  // namespace planemap::sources

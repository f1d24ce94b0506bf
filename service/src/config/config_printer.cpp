#include <spdlog/fmt/fmt.h>

#include <iterator>

#include "config/service_config.hpp"

namespace planemap::service {
namespace {

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (byte < 0x20 || byte == 0x7f) {
      out += fmt::format("\\x{:02x}", byte);
    } else {
      out += c;
    }
  }
  return out + '"';
}

template <class Number>
requires std::is_arithmetic_v<Number> std::string value_text(Number value) {
  return fmt::format("{}", value);  // the shortest text that reads back to the same number
}
std::string value_text(const std::string& value) {
  return quoted(value);
}
std::string value_text(const std::vector<double>& value) {
  return fmt::format("[{}]", fmt::join(value, ", "));
}

std::string limits_text(const FieldInfo& info, const char* of) {
  if (info.min == info.max) return fmt::format(" ({}{})", info.min, of);
  return fmt::format(" ({} to {}{})", info.min, info.max, of);
}
template <class T>
std::string allowed_text(const FieldInfo& info, const T&) {
  if constexpr (std::is_same_v<T, bool>) {
    return " (true or false)";
  } else if constexpr (std::is_arithmetic_v<T>) {
    return limits_text(info, "");
  } else if constexpr (std::is_same_v<T, std::string>) {
    return limits_text(info, " characters");
  } else {
    return limits_text(info, " numbers");
  }
}

/// Writes a struct's settings, one a line with a comment.
class Printer {
 public:
  explicit Printer(std::string& out) : out_(out) {}

  template <class Struct>
  void section(const SectionInfo& info, const Struct& value) {
    line(fmt::format("# {}", info.help));
    line(fmt::format("{}:", info.key));
    fields(value, "  ", "  ");
    line("");
  }
  void section(const SectionInfo& info, const std::vector<InputConfig>& inputs) {
    line(fmt::format("# {}", info.help));
    line(fmt::format("{}:", info.key));
    for (const auto& input : inputs) fields(input, "  - ", "    ");
    line("");
  }

 private:
  void line(const std::string& text) { out_ += text + "\n"; }
  void setting(const std::string& indent, const FieldInfo& info, const std::string& value, const std::string& allowed) {
    line(fmt::format("{:<44} # {}{}", fmt::format("{}{}: {}", indent, info.key, value), info.help, allowed));
  }

  template <class Struct>
  void fields(const Struct& value, std::string indent, const std::string& next_indent) {
    visit_fields(value, [&](const FieldInfo& info, const auto& field, const auto&... choices) {
      print(indent, info, field, choices...);
      indent = next_indent;
    });
  }
  template <class T>
  void print(const std::string& indent, const FieldInfo& info, const T& value) {
    setting(indent, info, value_text(value), allowed_text(info, value));
  }
  void print(const std::string& indent, const FieldInfo& info, const std::vector<MaskBox>& boxes) {
    setting(indent, info, boxes.empty() ? "[]" : "", " (min_m and max_m each)");
    const std::string inner(indent.size(), ' ');
    for (const auto& box : boxes) fields(box, inner + "  - ", inner + "    ");
  }
  template <class Enum>
  void print(const std::string& indent, const FieldInfo& info, Enum value,
             const std::initializer_list<Choice<Enum>>& choices) {
    std::vector<std::string> words;
    std::string word;
    for (const auto& choice : choices) {
      words.emplace_back(choice.first);
      if (choice.second == value) word = choice.first;
    }
    setting(indent, info, word, fmt::format(" ({})", fmt::join(words, ", ")));
  }
  void print(const std::string& indent, const FieldInfo& info, const std::string& value,
             const std::initializer_list<const char*>& choices) {
    setting(indent, info, value, fmt::format(" ({})", fmt::join(choices, ", ")));
  }

  std::string& out_;
};

}  // namespace

std::string to_yaml(const ServiceConfig& config) {
  std::string out;
  Printer printer(out);
  visit_sections(config, [&](const SectionInfo& info, const auto& section) { printer.section(info, section); });
  out.pop_back();  // the empty line behind the last section
  return out;
}

}  // namespace planemap::service

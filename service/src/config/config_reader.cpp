#include "config/config_reader.hpp"

#include <spdlog/fmt/fmt.h>
#include <yaml-cpp/yaml.h>

#include <cctype>
#include <charconv>
#include <cmath>
#include <optional>
#include <set>
#include <sstream>
#include <type_traits>

namespace planemap::service {
namespace {

/// Text for a person, cut where somebody put a book into a value.
std::string shown(const std::string& text) {
  constexpr int kMost = 60;
  return text.size() <= kMost ? text : fmt::format("{:.{}}...", text, kMost);
}

/// A number with nothing before or behind it.
template <class Number>
std::optional<Number> parse_number(const std::string& text) {
  Number value{};
  const char* begin = text.data() + (text.rfind('+', 0) == 0 ? 1 : 0);
  const auto [end, error] = std::from_chars(begin, text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

bool is_quoted(const YAML::Node& node) {
  return node.Tag() == "!";
}

std::string allowed_range(const FieldInfo& info) {
  if (std::isfinite(info.min) && std::isfinite(info.max)) return fmt::format("(allowed: {} to {})", info.min, info.max);
  return "(allowed: any finite number)";
}

const char* kind_of(const YAML::Node& node) {
  if (node.IsMap()) return "a section";
  if (node.IsSequence()) return "a list";
  return "nothing";
}

/// Reads YAML nodes into settings by the structs' own lists. One of these per document or override.
class NodeReader {
 public:
  NodeReader(std::string name, bool has_lines, ConfigProblems& problems)
      : name_(std::move(name)), has_lines_(has_lines), problems_(problems) {}

  void read_root(const YAML::Node& node, ServiceConfig& config) {
    if (node.IsNull()) return;
    read_map(node, "", [&](const auto& read) {
      visit_sections(config, [&](const SectionInfo& info, auto& section) { read(info.key, section); });
    });
  }

 private:
  struct Entry {
    YAML::Node key;
    YAML::Node value;
  };
  using Entries = std::map<std::string, Entry>;

  std::string place(const YAML::Node& node) const {
    return has_lines_ ? fmt::format("{}:{}", name_, node.Mark().line + 1) : name_;
  }
  void complain(const YAML::Node& node, const std::string& path, const std::string& what) {
    problems_.add(path, what, place(node));
  }
  static std::string join(const std::string& path, const std::string& key) {
    return path.empty() ? key : path + "." + key;
  }

  /// Reads the keys that `list_fields` names and complains of all others.
  template <class ListFields>
  void read_map(const YAML::Node& node, const std::string& path, const ListFields& list_fields) {
    if (!node.IsMap()) {
      return complain(node, path.empty() ? "configuration" : path,
                      fmt::format("must be keys with values, not {}",
                                  node.IsScalar() ? "'" + shown(node.Scalar()) + "'" : kind_of(node)));
    }
    Entries entries = entries_of(node, path);
    std::vector<std::string> known;
    list_fields([&](const char* key, auto& value, const auto&... more) {
      known.emplace_back(key);
      const auto entry = entries.find(key);
      if (entry == entries.end()) return;
      problems_.note_place(join(path, key), place(entry->second.key));
      if (!entry->second.value.IsNull()) {
        read_value(entry->second.value, join(path, key), value, more...);
      } else if (!path.empty()) {  // a section whose keys are all commented out is fine
        complain(entry->second.key, join(path, key), "has no value");
      }
      entries.erase(entry);
    });
    for (const auto& [key, entry] : entries) {
      const std::string guess = nearest_word(key, known);
      complain(entry.key, join(path, shown(key)),
               guess.empty() ? fmt::format("unknown key (allowed: {})", fmt::join(known, ", "))
                             : fmt::format("unknown key; did you mean {}?", guess));
    }
  }

  Entries entries_of(const YAML::Node& node, const std::string& path) {
    Entries entries;
    for (const auto& entry : node) {
      if (!entry.first.IsScalar()) {
        complain(entry.first, path.empty() ? "configuration" : path, "a key must be a word");
      } else if (!entries.emplace(entry.first.Scalar(), Entry{entry.first, entry.second}).second) {
        complain(entry.first, join(path, shown(entry.first.Scalar())), "given twice");
      }
    }
    return entries;
  }

  /// A section, or one element of a list of structs.
  template <class Struct>
  void read_value(const YAML::Node& node, const std::string& path, Struct& value) {
    read_map(node, path, [&](const auto& read) {
      visit_fields(value, [&](const FieldInfo& info, auto& field, const auto&... choices) {
        read(info.key, field, info, choices...);
      });
    });
  }
  void read_value(const YAML::Node& node, const std::string& path, std::vector<InputConfig>& value) {
    read_list(node, path, value, FieldInfo{"inputs", "", 1, 64});
  }
  void read_value(const YAML::Node& node, const std::string& path, std::vector<MaskBox>& value, const FieldInfo& info) {
    read_list(node, path, value, info);
  }

  template <class Struct>
  void read_list(const YAML::Node& node, const std::string& path, std::vector<Struct>& value, const FieldInfo& info) {
    if (node.IsMap() && !has_lines_) return read_element(node, path, value);
    if (!node.IsSequence()) return complain(node, path, "must be a list");
    if (!check_length(node, path, node.size(), info, "entries")) return;
    value.clear();
    for (const auto& element : node) {
      const std::string element_path = join(path, std::to_string(value.size()));
      problems_.note_place(element_path, place(element));
      value.emplace_back();
      read_value(element, element_path, value.back());
    }
  }

  /// An override of one element: the map's only key is its number; the number behind the last one adds an element.
  template <class Struct>
  void read_element(const YAML::Node& node, const std::string& path, std::vector<Struct>& value) {
    for (const auto& [key, entry] : entries_of(node, path)) {
      const YAML::Node& element = entry.value;
      const auto index = parse_number<std::size_t>(key);
      if (!index || *index > value.size() || *index >= 64) {
        complain(element, join(path, shown(key)), fmt::format("no such entry (allowed: 0 to {})", value.size()));
        continue;
      }
      if (*index == value.size()) value.emplace_back();
      problems_.note_place(join(path, key), place(element));
      read_value(element, join(path, key), value[*index]);
    }
  }

  /// The scalar's text; empty after a complaint.
  std::optional<std::string> scalar(const YAML::Node& node, const std::string& path, const std::string& wanted) {
    if (node.IsScalar()) return node.Scalar();
    complain(node, path, fmt::format("must be {}, not {}", wanted, kind_of(node)));
    return std::nullopt;
  }

  bool check_length(const YAML::Node& node, const std::string& path, std::size_t length, const FieldInfo& info,
                    const char* what) {
    const auto count = static_cast<double>(length);
    if (count >= info.min && count <= info.max) return true;
    complain(node, path,
             info.min == info.max ? fmt::format("has {} {}, must have {}", length, what, info.min)
                                  : fmt::format("has {} {} {}", length, what, allowed_range(info)));
    return false;
  }

  template <class Number>
  requires std::is_arithmetic_v<Number>
  void read_value(const YAML::Node& node, const std::string& path, Number& value, const FieldInfo& info) {
    const char* wanted = std::is_integral_v<Number> ? "a whole number" : "a number";
    const auto text = scalar(node, path, wanted);
    if (!text) return;
    const auto number = is_quoted(node) ? std::nullopt : parse_number<Number>(*text);
    if (!number)
      return complain(node, path, fmt::format("'{}' is not {} {}", shown(*text), wanted, allowed_range(info)));
    const auto real = static_cast<double>(*number);
    if (!std::isfinite(real) || real < info.min || real > info.max) {
      return complain(node, path, fmt::format("{} is out of range {}", shown(*text), allowed_range(info)));
    }
    value = *number;
  }

  void read_value(const YAML::Node& node, const std::string& path, bool& value, const FieldInfo&) {
    const auto text = scalar(node, path, "true or false");
    if (!text) return;
    if (is_quoted(node) || (*text != "true" && *text != "false")) {
      return complain(node, path, fmt::format("'{}' is not a truth value (allowed: true, false)", shown(*text)));
    }
    value = *text == "true";
  }

  void read_value(const YAML::Node& node, const std::string& path, std::string& value, const FieldInfo& info) {
    const auto text = scalar(node, path, "text");
    if (text && check_length(node, path, text->size(), info, "characters")) value = *text;
  }

  void read_value(const YAML::Node& node, const std::string& path, std::vector<double>& value, const FieldInfo& info) {
    if (!node.IsSequence()) return complain(node, path, "must be a list of numbers, for instance [0, 0, 1]");
    if (!check_length(node, path, node.size(), info, "numbers")) return;
    std::vector<double> numbers;
    for (const auto& element : node) {
      numbers.emplace_back();
      read_value(element, join(path, std::to_string(numbers.size() - 1)), numbers.back(), FieldInfo{"", "", -1e9, 1e9});
    }
    value = std::move(numbers);
  }

  template <class Enum>
  void read_value(const YAML::Node& node, const std::string& path, Enum& value, const FieldInfo&,
                  const std::initializer_list<Choice<Enum>>& choices) {
    std::vector<std::string> words;
    for (const auto& choice : choices) words.emplace_back(choice.first);
    const auto index = read_word(node, path, words);
    if (index) value = (choices.begin() + *index)->second;
  }
  void read_value(const YAML::Node& node, const std::string& path, std::string& value, const FieldInfo&,
                  const std::initializer_list<const char*>& choices) {
    const std::vector<std::string> words(choices.begin(), choices.end());
    const auto index = read_word(node, path, words);
    if (index) value = words[*index];
  }
  std::optional<std::size_t> read_word(const YAML::Node& node, const std::string& path,
                                       const std::vector<std::string>& words) {
    const auto text = scalar(node, path, "a word");
    if (!text) return std::nullopt;
    for (std::size_t i = 0; i < words.size(); ++i) {
      if (words[i] == *text) return i;
    }
    complain(node, path, fmt::format("'{}' is not known (allowed: {})", shown(*text), fmt::join(words, ", ")));
    return std::nullopt;
  }

  std::string name_;
  bool has_lines_;
  ConfigProblems& problems_;
};

/// YAML::LoadAll() would tell, too, but never ends on a stray comma.
bool has_second_document(const std::string& text) {
  bool begun = false;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const bool marks =
        line.starts_with("---") && (line.size() == 3 || std::isspace(static_cast<unsigned char>(line[3])));
    if (marks && begun) return true;
    const auto first = line.find_first_not_of(" \t\r");
    begun = begun || marks || (first != std::string::npos && line[first] != '#' && line[0] != '%');
  }
  return false;
}

}  // namespace

void apply_yaml(const std::string& text, const std::string& name, ServiceConfig& config, ConfigProblems& problems) {
  try {
    if (has_second_document(text)) problems.add("configuration", "more than one YAML document", name);
    const YAML::Node document = YAML::Load(text);
    if (!document.IsNull()) NodeReader(name, /*has_lines=*/true, problems).read_root(document, config);
  } catch (const YAML::Exception& e) {
    problems.add("YAML", e.msg, e.mark.is_null() ? name : fmt::format("{}:{}", name, e.mark.line + 1));
  }
}

void apply_override(const std::string& assignment, ServiceConfig& config, ConfigProblems& problems) {
  const std::string place = "--set " + shown(assignment);
  const auto equals = assignment.find('=');
  std::string path = assignment.substr(0, equals);
  if (equals == std::string::npos || path.find('.') == std::string::npos) {
    return problems.add("override", "must be section.key=value, for instance grid.cell_size_m=0.05", place);
  }
  try {
    YAML::Node node = YAML::Load(assignment.substr(equals + 1));
    // An empty value is an empty word: --set lcm.url=
    if (node.IsNull() && equals + 1 == assignment.size()) node = YAML::Node(std::string());
    while (!path.empty()) {
      const auto dot = path.rfind('.');
      YAML::Node parent;
      parent[dot == std::string::npos ? path : path.substr(dot + 1)] = node;
      node.reset(parent);
      path.resize(dot == std::string::npos ? 0 : dot);
    }
    NodeReader(place, /*has_lines=*/false, problems).read_root(node, config);
  } catch (const YAML::Exception& e) {
    problems.add("YAML", e.msg, place);
  }
}

}  // namespace planemap::service

#include "merge/map_merge.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <planemap/mapper.hpp>
#include <sstream>
#include <utility>

#include "build/input_hash.hpp"
#include "config/parse_config.hpp"
#include "store/map_reader.hpp"
#include "store/map_store.hpp"

namespace planemap::cli {
namespace {

using service::ServiceConfig;

/// Maps whose gravity is farther apart are not of the frames that they are said to be.
constexpr double kMostGravityApartDeg = 5.0;

std::optional<Eigen::Vector3d> gravity_of(const MergeInput& input) {
  return input.map.facts.gravity_direction();
}

/// The settings of the method, a line each, "section.key: value".
std::vector<std::string> method_settings(const ServiceConfig& config) {
  ServiceConfig method;
  method.mapper = config.mapper;
  method.mapper.core = {};  // how it is computed changes last digits only
  std::istringstream lines(service::to_yaml(method));
  std::vector<std::string> settings;
  std::string section;
  for (std::string line; std::getline(lines, line);) {
    if (line.empty() || line.front() == '#') continue;
    if (line.front() != ' ') {
      section = line.substr(0, line.find(':'));
      continue;
    }
    const std::string setting = line.substr(0, line.find(" #"));
    const auto begin = setting.find_first_not_of(' ');
    const auto end = setting.find_last_not_of(' ');
    if (begin != std::string::npos) settings.push_back(section + "." + setting.substr(begin, end - begin + 1));
  }
  return settings;
}

std::string settings_that_differ(const MergeInput& first, const MergeInput& other) {
  const auto ours = method_settings(first.config);
  const auto theirs = method_settings(other.config);
  std::string text;
  for (std::size_t i = 0; i < std::min(ours.size(), theirs.size()); ++i) {
    if (ours[i] == theirs[i]) continue;
    text += (text.empty() ? "" : "; ") + theirs[i] + ", not" + ours[i].substr(ours[i].find(':') + 1);
  }
  return text;
}

std::string objection_to_pair(const MergeInput& first, const MergeInput& other, const MergeOptions& options) {
  const std::string names = fmt::format("{} and {}", first.path.string(), other.path.string());
  const auto& a = *first.map.snapshot;
  const auto& b = *other.map.snapshot;
  if (a.epoch() == b.epoch()) {
    return fmt::format("{} are states of one map (epoch {}): what both saw would count twice", names, a.epoch());
  }
  if (a.cell_size_m() != b.cell_size_m()) {
    return fmt::format("{} have cells of {} m and {} m: cells of different sizes do not add up", names, a.cell_size_m(),
                       b.cell_size_m());
  }
  if (!options.T_first_second && first.map.facts.frame != other.map.facts.frame) {
    return fmt::format("{} are of the frames '{}' and '{}': --transform says where the second one is in the first",
                       names, first.map.facts.frame, other.map.facts.frame);
  }
  const auto down = gravity_of(first);
  auto other_down = gravity_of(other);
  if (other_down && options.T_first_second) other_down = options.T_first_second->linear() * *other_down;
  if (down && other_down) {
    const double apart_deg = std::atan2(down->cross(*other_down).norm(), down->dot(*other_down)) * 180.0 / M_PI;
    if (apart_deg > kMostGravityApartDeg) {
      return fmt::format("{}: their directions of gravity are {:.1f} degrees apart in the first one's frame: {}", names,
                         apart_deg, options.T_first_second ? "the transform is wrong" : "they are of different frames");
    }
  }
  if (const std::string differ = settings_that_differ(first, other); !options.first_settings && !differ.empty()) {
    return fmt::format("{} was mapped with other settings than {}: {}; --first-settings merges them with those of {}",
                       other.path.string(), first.path.string(), differ, first.path.string());
  }
  return {};
}

/// Names the sum: the same states of the same maps, placed alike, give the same number.
std::uint64_t epoch_of_sum(const std::vector<MergeInput>& inputs, const MergeOptions& options) {
  std::string text = "merge\n";
  for (const MergeInput& input : inputs) {
    const auto& map = *input.map.snapshot;
    text +=
        fmt::format("{} {} {} {} {}\n", map.epoch(), map.revision(), map.utime(), map.cell_count(), map.state().scans);
  }
  if (options.T_first_second) {
    const Eigen::Matrix4d matrix = options.T_first_second->matrix();
    for (Eigen::Index i = 0; i < 16; ++i) text += fmt::format("{} ", matrix.data()[i]);
  }
  return epoch_of(text);
}

service::MapFacts facts_of_sum(const std::vector<MergeInput>& inputs, const MergeOptions& options) {
  service::MapFacts facts = inputs.front().map.facts;
  for (std::size_t i = 1; i < inputs.size() && facts.gravity.empty(); ++i) {
    auto down = gravity_of(inputs[i]);
    if (!down) continue;
    if (options.T_first_second) down = options.T_first_second->linear() * *down;
    ServiceConfig config = inputs.front().config;
    config.map.gravity = {down->x(), down->y(), down->z()};
    facts.gravity = service::facts_of(config).gravity;
    facts.config = service::to_yaml(config);
  }
  return facts;
}

}  // namespace

Expected<MergeInput> read_merge_input(const std::filesystem::path& path) {
  MergeInput input;
  input.path = path;
  auto map = service::MapFile::read(path);
  if (!map) return fail(map.error().message);
  input.map = std::move(*map);
  auto config = service::parse_config(input.map.facts.config, path.string());
  if (!config) return fail(config.error().message);
  input.config = std::move(*config);
  return input;
}

std::string objection_to(const std::vector<MergeInput>& inputs, const MergeOptions& options) {
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    for (std::size_t k = i + 1; k < inputs.size(); ++k) {
      if (std::string why = objection_to_pair(inputs[i], inputs[k], options); !why.empty()) return why;
    }
  }
  return {};
}

Expected<MergeResult> merge_maps(const std::vector<MergeInput>& inputs, const MergeOptions& options,
                                 const std::function<void(double share)>& progress) {
  MergeResult result;
  auto base = std::make_shared<const MapSnapshot>(inputs.front().map.continued());
  auto mapper = Mapper::restore(inputs.front().config.mapper, *base);
  if (!mapper) return fail(inputs.front().path.string() + ": " + mapper.error().message);
  const double count = static_cast<double>(inputs.size() - 1);
  for (std::size_t i = 1; i < inputs.size(); ++i) {
    const auto share = [&, done = static_cast<double>(i - 1)](double part) {
      if (progress) progress((done + part) / count);
    };
    const auto added = mapper->add(*inputs[i].map.snapshot, options.T_first_second, share);
    if (!added) return fail(inputs[i].path.string() + ": " + added.error().message);
    result.new_planes += added->new_planes;
    result.merged_planes += added->merged_planes;
  }
  auto parts = service::parts_of(*mapper->snapshot());
  parts.epoch = epoch_of_sum(inputs, options);
  result.map = std::make_shared<const MapSnapshot>(std::move(parts));
  result.facts = facts_of_sum(inputs, options);
  return result;
}

}  // namespace planemap::cli

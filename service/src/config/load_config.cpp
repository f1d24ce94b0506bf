#include <spdlog/fmt/fmt.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <optional>

#include "config/config_reader.hpp"
#include "config/service_config.hpp"

namespace planemap::service {
namespace {

/// No configuration of a person's is longer; keeps a wrong file name from filling the memory.
constexpr std::size_t kMaxFileBytes = 1 << 20;

Expected<std::string> read_file(const std::string& name) {
  std::ifstream file(name, std::ios::binary);
  if (!file) return fail(fmt::format("{}: cannot be read: {}", name, std::strerror(errno)));
  std::string text(kMaxFileBytes + 1, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (file.bad()) return fail(fmt::format("{}: cannot be read: {}", name, std::strerror(errno)));
  text.resize(static_cast<std::size_t>(file.gcount()));
  if (text.size() > kMaxFileBytes) {
    return fail(fmt::format("{}: is larger than {} bytes; is it a configuration?", name, kMaxFileBytes));
  }
  return text;
}

std::optional<Preset> preset_of(const std::string& name) {
  if (name == "best") return Preset::kBest;
  if (name == "paper") return Preset::kPaper;
  return std::nullopt;
}

}  // namespace

Expected<ServiceConfig> load_config(const ConfigSources& sources) {
  const auto which = preset_of(sources.preset);
  if (!which) return fail(fmt::format("--preset: '{}' is not known (allowed: best, paper)", sources.preset));
  ServiceConfig config;
  config.mapper = preset(*which);
  ConfigProblems problems;
  if (!sources.file.empty()) {
    auto text = read_file(sources.file);
    if (!text) return tl::make_unexpected(text.error());
    apply_yaml(*text, sources.file, config, problems);
  }
  for (const auto& assignment : sources.overrides) apply_override(assignment, config, problems);
  check_config(config, problems);
  if (!problems.empty()) return fail(problems.text());
  config.mapper.pose_error = config.pose.error;
  return config;
}

std::string effective_lcm_url(const LcmConfig& config) {
  std::string url = config.url;
  if (url.empty()) {
    const char* from_environment = std::getenv("LCM_DEFAULT_URL");
    url = from_environment != nullptr && *from_environment != '\0' ? from_environment : kDefaultLcmUrl;
  }
  if (url.rfind("udpm", 0) != 0 || url.find("recv_buf_size=") != std::string::npos) return url;
  return fmt::format("{}{}recv_buf_size={}", url, url.find('?') == std::string::npos ? "?" : "&",
                     config.recv_buf_bytes);
}

}  // namespace planemap::service

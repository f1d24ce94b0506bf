#include "config/parse_config.hpp"

#include "config/config_reader.hpp"

namespace planemap::service {

Expected<ServiceConfig> parse_config(const std::string& yaml, const std::string& name) {
  ServiceConfig config;
  ConfigProblems problems;
  apply_yaml(yaml, name, config, problems);
  check_config(config, problems);
  if (!problems.empty()) return fail(problems.text());
  config.mapper.pose_error = config.pose.error;
  return config;
}

}  // namespace planemap::service

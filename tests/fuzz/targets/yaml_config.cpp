#include "config/config_reader.hpp"
#include "fuzz_input.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace planemap;
  using namespace planemap::fuzz;
  Input input(data, size);
  const std::size_t kind = take_choice(input, 2);
  const std::string text(input.begin(), input.end());
  service::ServiceConfig config;
  service::ConfigProblems problems;
  if (kind == 0) {
    service::apply_yaml(text, "planemapd.yaml", config, problems);
  } else {
    service::apply_override(text, config, problems);
  }
  service::check_config(config, problems);
  require(problems.empty() || !problems.text().empty(), "problems without words");
  return 0;
}

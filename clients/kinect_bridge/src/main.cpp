#include <chrono>
#include <cstdio>
#include <exception>
#include <memory>
#include <planemap/simulation/scenes.hpp>
#include <planemap/simulation/simulated_source.hpp>
#include <planemap/simulation/truth_file.hpp>
#include <planemap/sources/open_folder.hpp>

#include "feed.hpp"
#include "looped_source.hpp"
#include "options.hpp"
#include "progress.hpp"
#include "sink.hpp"
#include "stop_signals.hpp"
#include "summary.hpp"

namespace planemap::kinect_bridge {
namespace {

int complain(const std::string& message) {
  std::fprintf(stderr, "planemap-kinect-bridge: %s\n", message.c_str());
  return 1;
}

Expected<std::unique_ptr<sources::FrameSource>> open_source(const Options& options) {
  if (!options.dataset.empty()) {
    const auto open = [&options] { return sources::open_folder(options.dataset, options.folder); };
    return options.loop ? LoopedSource::open(open) : open();
  }
  return std::make_unique<simulation::SimulatedSource>(options.simulation);
}

/// Writes what is known of a simulated scene so far, where that was asked for.
Expected<void> write_truth(const sources::FrameSource& source, const Options& options) {
  const auto* simulated = dynamic_cast<const simulation::SimulatedSource*>(&source);
  if (simulated == nullptr || options.truth_path.empty()) return {};
  return simulation::write_truth_file(simulated->truth(), options.truth_path);
}

Expected<std::unique_ptr<Sink>> open_sink(const Options& options) {
  return options.log_path.empty() ? open_lcm_sink(options.lcm_url) : open_log_sink(options.log_path);
}

int run(const Options& options) {
  StopSignals stop;
  auto source = open_source(options);
  if (!source) return complain(source.error().message);
  if (auto written = write_truth(**source, options); !written) return complain(written.error().message);
  auto sink = open_sink(options);
  if (!sink) return complain(sink.error().message);

  const auto begin = std::chrono::steady_clock::now();
  Summary summary;
  {
    Progress progress(!options.quiet, options.feed.frames ? options.feed.frames : (*source)->size());
    Feed feed(**source, **sink, options.feed, [&stop](auto time) { return stop.wait_until(time); });
    const auto report = feed.run([&progress](const FeedReport& so_far) { progress.show(so_far); });
    if (!report) return complain(report.error().message);
    summary.report = *report;
  }
  if (options.simulation.scene == simulation::kBuildingScene) {  // now it is known what was seen of it
    if (auto written = write_truth(**source, options); !written) return complain(written.error().message);
  }
  summary.skipped = (*source)->skipped();
  summary.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  if (!options.quiet) std::fputs(summary_text(summary, options).c_str(), stderr);
  if (options.json) std::fputs(summary_json(summary, options).c_str(), stdout);
  if (summary.report.frames == 0 && !summary.report.stopped)
    return complain("the source has no frame that can be used");
  return 0;
}

}  // namespace
}  // namespace planemap::kinect_bridge

int main(int argc, char** argv) {
  using namespace planemap::kinect_bridge;
  try {
    const ParsedOptions parsed = parse_options(argc, argv);
    return parsed.options ? run(*parsed.options) : parsed.exit_code;
  } catch (const std::exception& error) {
    return complain(error.what());
  }
}

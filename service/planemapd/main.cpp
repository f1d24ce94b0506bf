// The daemon: scans and poses in over LCM, a plane map out.

#include <pthread.h>
#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <fstream>
#include <functional>
#include <memory>
#include <sstream>
#include <string>
#include <thread>
#include <utility>

#include "common/clock.hpp"
#include "common/version.hpp"
#include "config/service_config.hpp"
#include "ingest/kernel_drops.hpp"
#include "logging.hpp"
#include "serve/grpc/grpc_server.hpp"
#include "serve/http/http_server.hpp"
#include "service.hpp"
#include "service_manager.hpp"
#include "store/map_saver.hpp"
#include "store/map_store.hpp"

namespace planemap::service {
namespace {

constexpr int kDone = 0;
constexpr int kFailed = 1;
constexpr int kWrongUse = 2;

struct Arguments {
  ConfigSources sources;
  std::string lcm_url;
  std::string map;
  bool print_config = false;
};

void define_options(CLI::App& app, Arguments& arguments) {
  app.set_version_flag("--version", std::string("planemapd ") + version());
  app.add_option("-c,--config", arguments.sources.file, "settings in YAML; --print-config shows all of them")
      ->type_name("FILE");
  app.add_option("--preset", arguments.sources.preset,
                 "method to begin with: best, or paper for the paper's reading alone")
      ->type_name("best|paper")
      ->capture_default_str();
  app.add_option("--set", arguments.sources.overrides, "one setting, wins over the file; may be given more than once")
      ->type_name("SECTION.KEY=VALUE")
      ->allow_extra_args(false);
  app.add_option("-l,--lcm-url", arguments.lcm_url, "bus; else lcm.url, else LCM_DEFAULT_URL of the environment")
      ->type_name("URL");
  app.add_option("--map", arguments.map, "map file to go on with, made where there is none; wins over store.path")
      ->type_name("FILE");
  app.add_flag("--print-config", arguments.print_config, "print the settings that would be used, and end");
  app.footer(
      "Exit codes: 0 ended by SIGTERM or SIGINT, 1 failed, 2 wrong use or configuration.\n"
      "Example: planemapd --set grid.cell_size_m=0.05 --set inputs.0.channel=KINECT");
}

/// Microseconds since 1970, so a later life of the map has a greater epoch; below 2^53 for two centuries more.
std::uint64_t new_epoch() {
  return static_cast<std::uint64_t>(utime_now());
}

std::string text_of(const char* path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

void log_start(const ServiceConfig& config, const std::string& url) {
  spdlog::info("planemapd {}, bus {}", version(), url);
  for (const auto& input : config.inputs) {
    spdlog::info("input {}: scans on {}, poses on {}", input.name, input.channel, input.pose_channel);
  }
  const std::string advice = receive_buffer_advice(url, text_of("/proc/sys/net/core/rmem_max"));
  if (!advice.empty()) spdlog::warn("{}", advice);
  spdlog::info("configuration:\n{}", to_yaml(config));
}

/// @param meanwhile  is done once in each period
int wait_for_signal(const sigset_t& signals, std::chrono::microseconds period, const std::function<void()>& meanwhile) {
  constexpr std::int64_t kSecond = 1000000;
  const timespec timeout{period.count() / kSecond, 1000 * (period.count() % kSecond)};
  while (true) {
    const int signal = sigtimedwait(&signals, nullptr, &timeout);
    if (signal > 0) return signal;
    meanwhile();
  }
}

/// Tells others how the service is: gRPC health, and the service manager. A mapper that hangs is not alive, so that the
/// service manager's watchdog ends the daemon.
class Reporter {
 public:
  Reporter(Service& service, GrpcServer* grpc) : service_(service), grpc_(grpc) {
    told_ = text();
    manager_.ready(told_);
  }

  void report() {
    const double now_s = steady_now_s();
    const HealthReport ready = service_.health().readiness(now_s);
    if (grpc_ != nullptr) grpc_->set_serving(ready.is_good);
    if (service_.health().liveness(now_s).is_good) manager_.beat();
    std::string now = ready.is_good ? text() : ready.reason;
    if (now == told_) return;
    manager_.status(now);
    told_ = std::move(now);
  }
  void end() { manager_.stopping(); }
  std::chrono::microseconds period() const {
    constexpr std::chrono::microseconds kLongest = std::chrono::seconds(1);
    return std::min(kLongest, manager_.beat_period().value_or(kLongest));
  }

 private:
  std::string text() const {
    const auto snapshot = service_.snapshot();
    return fmt::format("{} planes, {} cells, {} scans mapped", snapshot->planes().size(), snapshot->cell_count(),
                       service_.mapping().stats(steady_now_s()).mapped);
  }

  Service& service_;
  GrpcServer* grpc_;
  ServiceManager manager_;
  std::string told_;
};

/// Runs until SIGTERM or SIGINT. The signals are blocked in every thread and waited for here, so no handler ever runs.
int serve(const ServiceConfig& config) {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGTERM);
  sigaddset(&signals, SIGINT);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  std::signal(SIGPIPE, SIG_IGN);  // a reader of the log may go away; the daemon stays

  const std::string url = effective_lcm_url(config.lcm);
  const std::uint64_t epoch = new_epoch();
  log_start(config, url);
  const auto bus = open_bus(url);
  if (!bus) {
    spdlog::error("{}", bus.error().message);
    return kFailed;
  }
  std::unique_ptr<MapStore> store;
  if (!config.store.path.empty()) {
    auto opened = open_store(config, epoch);
    if (!opened) {
      spdlog::error("{}", opened.error().message);
      return kFailed;
    }
    store = std::make_unique<MapStore>(std::move(*opened));
  }
  Service service(config, **bus, epoch, store ? store->initial.get() : nullptr);
  spdlog::info("the map is of epoch {}", service.snapshot()->epoch());
  std::unique_ptr<MapSaver> saver;
  if (store) {
    store->initial.reset();
    saver = std::make_unique<MapSaver>(config.store, std::move(*store), service.mapping(), service.counter_board());
    service.mapping().set_keeper(saver.get());
  }
  std::unique_ptr<GrpcServer> grpc;
  if (!config.grpc.listen.empty()) {
    auto started = GrpcServer::start(config, service.mapping(), service.status_board(), service.counter_board());
    if (!started) {
      spdlog::error("{}", started.error().message);
      return kFailed;
    }
    grpc = std::move(*started);
    service.set_snapshot_listener([&grpc] { grpc->wake(); });
    spdlog::info("gRPC on {}{}", grpc->address(), config.grpc.tls_certificate.empty() ? "" : " with TLS");
  }
  std::unique_ptr<HttpServer> http;
  if (!config.http.listen.empty()) {
    auto started = HttpServer::start(config, service);
    if (!started) {
      spdlog::error("{}", started.error().message);
      return kFailed;
    }
    http = std::move(*started);
    spdlog::info("the map, to look at: {}", http->url());
  }
  service.health().begin();
  std::jthread bus_thread([&service](const std::stop_token& stop) { service.run(stop); });
  Reporter reporter(service, grpc.get());
  const int signal = wait_for_signal(signals, reporter.period(), [&reporter] { reporter.report(); });
  pthread_sigmask(SIG_UNBLOCK, &signals, nullptr);  // a second one ends the process at once
  spdlog::info("{}: ending", signal == SIGINT ? "SIGINT" : "SIGTERM");
  service.health().end();
  reporter.end();
  if (http) http->stop();
  if (grpc) grpc->stop();
  service.set_snapshot_listener({});
  bus_thread.request_stop();
  bus_thread.join();
  service.stop();
  service.mapping().set_keeper(nullptr);
  if (saver) saver->stop();
  const auto snapshot = service.snapshot();
  spdlog::info("ended with {} planes, {} cells, revision {}", snapshot->planes().size(), snapshot->cell_count(),
               snapshot->revision());
  return kDone;
}

int run(int argc, char** argv) {
  CLI::App app("planemapd: makes a map of planes from depth scans and poses that come in over LCM", "planemapd");
  Arguments arguments;
  define_options(app, arguments);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? kDone : kWrongUse;
  }
  auto config = load_config(arguments.sources);
  if (!config) {
    std::fprintf(stderr, "planemapd: the configuration cannot be used:\n%s\n", config.error().message.c_str());
    return kWrongUse;
  }
  if (!arguments.lcm_url.empty()) config->lcm.url = arguments.lcm_url;
  if (!arguments.map.empty()) config->store.path = arguments.map;
  if (arguments.print_config) {
    std::fputs(to_yaml(*config).c_str(), stdout);
    return kDone;
  }
  set_up_logging(config->log);
  return serve(*config);
}

}  // namespace
}  // namespace planemap::service

int main(int argc, char** argv) {
  try {
    return planemap::service::run(argc, argv);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "planemapd: %s\n", e.what());
    return 1;
  }
}

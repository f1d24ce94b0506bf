// Load on the gRPC server while it maps: latency of single calls, nearest queries in batches, what watchers cost the
// mapper. All of it, clients too, shares one process and one machine.

#include <grpcpp/grpcpp.h>
#include <planemap/v1/planemap_service.grpc.pb.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <memory>
#include <random>
#include <thread>
#include <vector>

#include "bench_frames.hpp"
#include "common/stopwatch.hpp"
#include "frame_source.hpp"
#include "mapping/mapping_service.hpp"
#include "serve/grpc/grpc_server.hpp"

namespace planemap::benchmark {
namespace {

using namespace planemap::service;

struct Arguments {
  std::string dataset;
  int frames = 300;
  double rate_hz = 30.0;
  double seconds = 10.0;
  int watchers = 50;
  int rounds = 5;
};

double percentile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// The daemon without its bus: frames go to the mapper at a steady rate, forth and back.
class Daemon {
 public:
  explicit Daemon(const Arguments& arguments) : frames_(read(arguments)), period_s_(1.0 / arguments.rate_hz) {
    config_.grpc.listen = "127.0.0.1:0";
    intake_ = std::make_unique<ScanIntake>(
        config_, counters_, [](RegisteredScan&&) {}, [](const std::string&) {});
    mapping_ = std::make_unique<MappingService>(config_, 1, counters_, [this] {
      if (server_) server_->wake();
    });
    auto started = GrpcServer::start(config_, *mapping_, StatusBoard(*intake_, *mapping_, counters_), counters_);
    if (!started) throw std::runtime_error(started.error().message);
    server_ = std::move(*started);
    feeder_ = std::jthread([this](const std::stop_token& stop) { feed(stop); });
  }
  ~Daemon() {
    feeder_.request_stop();
    feeder_.join();
    mapping_->stop();  // its thread wakes the server
    server_->stop();
  }
  Daemon(const Daemon&) = delete;
  Daemon& operator=(const Daemon&) = delete;

  std::unique_ptr<v1::PlaneMap::Stub> stub() const {
    grpc::ChannelArguments own;
    own.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
    return v1::PlaneMap::NewStub(
        grpc::CreateCustomChannel(server_->address(), grpc::InsecureChannelCredentials(), own));
  }
  MappingStats stats() const { return mapping_->stats(steady_now_s()); }
  std::size_t planes() const { return mapping_->snapshot()->planes().size(); }
  /// Until so many more scans are mapped.
  void wait_for_scans(std::int64_t count) const {
    for (const auto end = stats().mapped + count; stats().mapped < end;) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  }

 private:
  static std::vector<BenchFrame> read(const Arguments& arguments) {
    const auto tour = static_cast<std::size_t>(arguments.frames);
    auto frames = read_frames(*open_frames({.dataset = arguments.dataset}, tour), tour, SensorConfig{});
    if (frames.size() < 2) throw std::runtime_error("there are fewer than two frames");
    return frames;
  }
  void feed(const std::stop_token& stop) {
    const std::size_t turn = 2 * (frames_.size() - 1);
    auto due = std::chrono::steady_clock::now();
    for (std::size_t i = 0; !stop.stop_requested(); ++i) {
      const std::size_t place = i % turn < frames_.size() ? i % turn : turn - i % turn;
      RegisteredScan scan{0, frames_[place].scan, frames_[place].T_world_sensor};
      std::get<DepthScan>(scan.scan).utime = static_cast<std::int64_t>(1e6 * period_s_ * static_cast<double>(i + 1));
      counters_.scan_received();
      mapping_->push(std::move(scan));
      due += std::chrono::duration_cast<std::chrono::steady_clock::duration>(std::chrono::duration<double>(period_s_));
      std::this_thread::sleep_until(due);
    }
  }

  ServiceConfig config_;
  Counters counters_;
  std::vector<BenchFrame> frames_;
  const double period_s_;
  std::unique_ptr<ScanIntake> intake_;
  std::unique_ptr<MappingService> mapping_;
  std::unique_ptr<GrpcServer> server_;
  std::jthread feeder_;
};

/// One client that asks for one plane of so many points, again and again.
std::vector<double> ask_nearest(const Daemon& daemon, int points, double seconds) {
  const auto stub = daemon.stub();
  std::mt19937 engine(7);
  std::uniform_real_distribution<double> place(-4.0, 4.0);
  std::vector<double> times_ms;
  const Stopwatch total;
  while (total.ms() < 1e3 * seconds) {
    v1::NearestPlanesRequest request;
    for (int i = 0; i < points; ++i) {
      v1::NearestPoint& point = *request.add_points();
      point.mutable_point_m()->set_x(place(engine));
      point.mutable_point_m()->set_y(place(engine));
      point.mutable_point_m()->set_z(place(engine));
      point.set_sigma_m(0.01);
    }
    grpc::ClientContext context;
    v1::NearestPlanesResponse response;
    const Stopwatch watch;
    const auto status = stub->NearestPlanes(&context, request, &response);
    times_ms.push_back(watch.ms());
    if (!status.ok()) throw std::runtime_error(status.error_message());
  }
  return times_ms;
}

/// Clients that read what they are told, each on a connection of its own.
class Watchers {
 public:
  Watchers(const Daemon& daemon, int count) {
    for (int i = 0; i < count; ++i) {
      contexts_.push_back(std::make_unique<grpc::ClientContext>());
      threads_.emplace_back([this, context = contexts_.back().get(), stub = std::shared_ptr(daemon.stub())] {
        const auto reader = stub->Watch(context, {});
        for (v1::WatchEvent event; reader->Read(&event);) ++events_;
        reader->Finish();
      });
    }
  }
  ~Watchers() {
    for (auto& context : contexts_) context->TryCancel();
    for (auto& thread : threads_) thread.join();
  }
  Watchers(const Watchers&) = delete;
  Watchers& operator=(const Watchers&) = delete;
  std::int64_t events() const { return events_; }

 private:
  std::atomic<std::int64_t> events_ = 0;
  std::vector<std::unique_ptr<grpc::ClientContext>> contexts_;
  std::vector<std::thread> threads_;
};

void bench(const Arguments& arguments) {
  const Daemon daemon(arguments);
  daemon.wait_for_scans(100);
  const auto single = ask_nearest(daemon, 1, arguments.seconds);
  std::printf("unary, 1 point:       p50 %.3f ms, p99 %.3f ms, max %.1f ms (%zu calls; %zu planes, %.0f scans/s)\n",
              percentile(single, 0.5), percentile(single, 0.99), percentile(single, 1.0), single.size(),
              daemon.planes(), daemon.stats().rate_hz);
  const auto batches = ask_nearest(daemon, 100, arguments.seconds);
  std::printf("batches of 100:       p50 %.3f ms, p99 %.3f ms, %.0f nearest queries/s\n", percentile(batches, 0.5),
              percentile(batches, 0.99), 100.0 * static_cast<double>(batches.size()) / arguments.seconds);
  std::vector<double> ratios;
  for (int round = 0; round < arguments.rounds; ++round) {
    daemon.wait_for_scans(100);
    const double without_ms = daemon.stats().scan_ms_p50;
    double with_ms = 0.0;
    std::int64_t events = 0;
    {
      const Watchers watchers(daemon, arguments.watchers);
      daemon.wait_for_scans(100);
      with_ms = daemon.stats().scan_ms_p50;
      events = watchers.events();
    }
    ratios.push_back(with_ms / without_ms);
    std::printf("a scan, median of 100: %.2f ms; with %d watchers %.2f ms (%lld events): %.3f times\n", without_ms,
                arguments.watchers, with_ms, static_cast<long long>(events), ratios.back());
  }
  std::printf("watchers, median of %d rounds: %.3f times\n", arguments.rounds, percentile(ratios, 0.5));
}

}  // namespace
}  // namespace planemap::benchmark

int main(int argc, char** argv) {
  planemap::benchmark::Arguments arguments;
  CLI::App app("planemap-grpc-bench: load on the gRPC server while it maps", "planemap-grpc-bench");
  app.add_option("--dataset", arguments.dataset, "frames of a 7-Scenes or TUM RGB-D folder; else a simulated apartment")
      ->type_name("DIR");
  app.add_option("--frames", arguments.frames, "how many, at most")->check(CLI::Range(2, 10000))->capture_default_str();
  app.add_option("--rate", arguments.rate_hz, "scans a second")->check(CLI::Range(1.0, 1000.0))->capture_default_str();
  app.add_option("--seconds", arguments.seconds, "of each kind of call")
      ->check(CLI::Range(0.1, 3600.0))
      ->capture_default_str();
  app.add_option("--watchers", arguments.watchers, "at a time")->check(CLI::Range(1, 60))->capture_default_str();
  app.add_option("--rounds", arguments.rounds, "without and with watchers, in turn")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    planemap::benchmark::bench(arguments);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "planemap-grpc-bench: %s\n", e.what());
    return 1;
  }
  return 0;
}

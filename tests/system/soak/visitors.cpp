#include "soak/visitors.hpp"

#include <chrono>
#include <condition_variable>
#include <planemap/client/grpc_map_client.hpp>
#include <planemap/client/lcm_map_client.hpp>
#include <stdexcept>
#include <utility>

#include "support/http_client.hpp"

namespace planemap::system_test {

namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

constexpr milliseconds kTimeout{20'000};
constexpr milliseconds kLongestStay{3000};
constexpr milliseconds kLongestPause{1000};
constexpr std::size_t kKeptComplaints = 100;

milliseconds up_to(milliseconds most, std::mt19937& random) {
  return milliseconds(std::uniform_int_distribution<milliseconds::rep>(0, most.count())(random));
}

bool one_in(int n, std::mt19937& random) {
  return std::uniform_int_distribution(1, n)(random) == 1;
}

std::vector<client::QueryPoint> points(std::mt19937& random) {
  std::uniform_real_distribution<double> coordinate_m(-8.0, 8.0);
  std::vector<client::QueryPoint> points(100);
  for (auto& point : points) point.point_m = {coordinate_m(random), coordinate_m(random), 0.1 * coordinate_m(random)};
  return points;
}

/// The value, or what was said instead.
template <class Value>
Value got(const char* what, client::Expected<Value>&& answer) {
  if (!answer) throw std::runtime_error(std::string(what) + ": " + answer.error().message);
  return std::move(*answer);
}

}  // namespace

Visitors::Visitors(std::string lcm_url, std::string grpc_address, std::uint16_t http_port, unsigned seed)
    : lcm_url_(std::move(lcm_url)), grpc_address_(std::move(grpc_address)), http_port_(http_port) {
  come("lcm", seed, [this](Random& random, const std::stop_token& stop) { ask_over_lcm(random, stop); });
  come("grpc", seed + 1, [this](Random& random, const std::stop_token& stop) { ask_over_grpc(random, stop); });
  come("http", seed + 2, [this](Random& random, const std::stop_token& stop) { browse(random, stop); });
}

Visitors::~Visitors() {
  for (auto& thread : threads_) thread.request_stop();
}

std::map<std::string, std::int64_t> Visitors::visits() const {
  const std::lock_guard lock(mutex_);
  return visits_;
}

std::vector<std::string> Visitors::complaints() const {
  const std::lock_guard lock(mutex_);
  return complaints_;
}

void Visitors::come(const std::string& kind, unsigned seed,
                    const std::function<void(Random&, const std::stop_token&)>& visit) {
  threads_.emplace_back([this, kind, seed, visit](const std::stop_token& stop) {
    Random random(seed);
    std::mutex pause_mutex;
    std::condition_variable_any pause;
    while (!stop.stop_requested()) {
      std::string complaint;
      try {
        visit(random, stop);
      } catch (const std::exception& e) {
        complaint = e.what();
      }
      {
        const std::lock_guard lock(mutex_);
        ++visits_[kind];
        if (!complaint.empty() && complaints_.size() < kKeptComplaints) complaints_.push_back(kind + ": " + complaint);
      }
      std::unique_lock lock(pause_mutex);
      pause.wait_for(lock, stop, up_to(kLongestPause, random), [] { return false; });
    }
  });
}

void Visitors::ask_over_lcm(Random& random, const std::stop_token& stop) {
  const auto client = got("LCM", client::LcmMapClient::connect(lcm_url_));
  ask(*client, random, stop);
}

void Visitors::ask_over_grpc(Random& random, const std::stop_token& stop) {
  const auto client = got("gRPC", client::GrpcMapClient::connect(grpc_address_));
  ask(*client, random, stop);
}

void Visitors::ask(client::MapClient& client, Random& random, const std::stop_token& stop) {
  got("status", client.status(kTimeout));
  const client::Map map =
      one_in(4, random) ? got("whole map", client.whole_map(kTimeout)) : got("snapshot", client.snapshot(kTimeout));
  got("nearest", client.nearest(points(random), {}, kTimeout));
  if (!map.planes.empty()) got("plane", client.plane(map.planes.front().id, kTimeout));
  if (one_in(8, random)) got("floorplan", client.floorplan({}, kTimeout));
  if (one_in(4, random)) return;
  const auto watch = client.watch();
  for (const auto end = Clock::now() + up_to(kLongestStay, random); Clock::now() < end && !stop.stop_requested();) {
    got("watch", watch->next(kTimeout));  // scans come all the time
  }
}

void Visitors::browse(Random& random, const std::stop_token& stop) {
  if (one_in(5, random)) {
    TcpClient impolite(http_port_);  // half a request, and gone
    impolite.send("GET /api/v1/planes HTTP/1.1\r\nHost: ");
    return;
  }
  for (const char* target : {"/", "/healthz", "/metrics", "/api/v1/planes", "/api/v1/scan"}) {
    const HttpReply reply = http_get(http_port_, target);
    // There is a scan once somebody looks.
    if (reply.status != 200 && reply.status != 204 && reply.status != 404) {
      throw std::runtime_error(std::string(target) + ": status " + std::to_string(reply.status) + ", " + reply.body);
    }
  }
  TcpClient watcher(http_port_);
  watcher.send("GET /api/v1/events HTTP/1.1\r\nHost: localhost\r\n\r\n");
  if (watcher.read_until("event: hello").find("event: hello") == std::string::npos) {
    throw std::runtime_error("the event stream did not begin");
  }
  for (const auto end = Clock::now() + up_to(kLongestStay, random); Clock::now() < end && !stop.stop_requested();) {
    watcher.read_until("\n\n", milliseconds(200));
  }
}

}  // namespace planemap::system_test

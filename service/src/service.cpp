#include "service.hpp"

#include <spdlog/spdlog.h>

#include <cctype>
#include <chrono>
#include <exception>
#include <stdexcept>
#include <thread>
#include <utility>

namespace planemap::service {
namespace {

constexpr int kHandleTimeoutMs = 20;  // also how soon a stop is noticed, and a scan that waited too long
constexpr auto kBackOff = std::chrono::milliseconds(100);

/// LCM takes channels for regular expressions.
std::string escaped(const std::string& channel) {
  std::string pattern;
  for (const char c : channel) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '_') pattern += '\\';
    pattern += c;
  }
  return pattern;
}

}  // namespace

Service::Service(const ServiceConfig& config, lcm::LCM& bus, std::uint64_t epoch, const MapSnapshot* initial)
    : request_channel_(config.publish.request_channel),
      bus_(bus),
      // The mapper may have a snapshot before the server is made; it is not handed a scan before, though.
      mapping_(
          config, epoch, counters_, [this] { on_snapshot(); }, initial),
      health_(mapping_),
      intake_(
          config, counters_, [this](RegisteredScan&& scan) { mapping_.push(std::move(scan)); },
          [](const std::string& text) { spdlog::warn("{}", text); }),
      book_(config.map),
      server_(config, bus, mapping_, book_, StatusBoard(intake_, mapping_, counters_), counters_) {
  for (const auto& channel : intake_.channels()) subscribe(channel);
  subscribe(request_channel_);
}

Service::~Service() {
  stop();
}

void Service::on_snapshot() {
  server_.wake();
  const std::lock_guard lock(listener_mutex_);
  if (snapshot_listener_) snapshot_listener_();
}

void Service::set_snapshot_listener(std::function<void()> listener) {
  const std::lock_guard lock(listener_mutex_);
  snapshot_listener_ = std::move(listener);
}

void Service::subscribe(const std::string& channel) {
  if (bus_.subscribe(escaped(channel), &Service::on_message, this) == nullptr) {
    throw std::runtime_error("LCM cannot subscribe to " + channel);
  }
}

void Service::on_message(const lcm::ReceiveBuffer* buffer, const std::string& channel) noexcept {
  try {
    const std::span message(static_cast<const std::uint8_t*>(buffer->data), buffer->data_size);
    if (channel == request_channel_) {
      server_.on_request(message);
    } else {
      intake_.on_message(channel, message, steady_now_s());
    }
  } catch (const std::exception& e) {
    // LCM's C code is on the stack: nothing may be thrown through it.
    spdlog::error("a message on {} could not be handled: {}", channel, e.what());
  }
}

int Service::handle(int timeout_ms) {
  const int result = bus_.handleTimeout(timeout_ms);
  intake_.tick(steady_now_s());
  return result;
}

void Service::run(const std::stop_token& stop) {
  bool has_failed = false;
  while (!stop.stop_requested()) {
    const bool fails = handle(kHandleTimeoutMs) < 0;
    if (fails && !has_failed) spdlog::error("the LCM bus failed; trying on");
    if (!fails && has_failed) spdlog::info("the LCM bus is back");
    has_failed = fails;
    if (!fails) continue;
    counters_.add("lcm.handle_errors");
    std::this_thread::sleep_for(kBackOff);
  }
}

void Service::stop() {
  mapping_.stop();  // first: its thread wakes the server
  server_.stop();
}

Expected<std::unique_ptr<lcm::LCM>> open_bus(const std::string& url) {
  auto bus = std::make_unique<lcm::LCM>(url);
  // A udpm bus opens its receiving socket late; asking for the descriptor makes it do so now.
  if (bus->good() && bus->getFileno() >= 0) return bus;
  std::string message = "the LCM bus " + url + " cannot be opened";
  if (url.rfind("udpm", 0) == 0) {
    message +=
        "; for multicast on this machine alone, as root: ip link set lo up; ip link set lo multicast on; "
        "ip route add 224.0.0.0/4 dev lo";
  }
  return fail(std::move(message));
}

}  // namespace planemap::service

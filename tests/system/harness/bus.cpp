#include "harness/bus.hpp"

#include <stdexcept>

#include "harness/network.hpp"

namespace planemap::system_test {

Bus::Bus() : lcm_(kLcmUrl) {
  if (!lcm_.good()) throw std::runtime_error(std::string("LCM does not start with ") + kLcmUrl);
  lcm_.subscribe("PLANEMAP_STATUS", &Bus::on_status, this);
}

void Bus::on_status(const lcm::ReceiveBuffer* /*buffer*/, const std::string& /*channel*/,
                    const planemap_lcm::status_t* status) {
  status_ = *status;
}

std::int64_t Bus::counter(const std::string& name) const {
  if (!status_) return 0;
  for (const planemap_lcm::counter_t& counter : status_->counters) {
    if (counter.name == name) return counter.value;
  }
  return 0;
}

std::int64_t Bus::counters_beginning(const std::string& prefix) const {
  std::int64_t sum = 0;
  if (!status_) return sum;
  for (const planemap_lcm::counter_t& counter : status_->counters) {
    if (counter.name.starts_with(prefix)) sum += counter.value;
  }
  return sum;
}

std::string Bus::describe() const {
  if (!status_) return "no status was heard";
  std::string text = "revision " + std::to_string(status_->revision) + ", planes " +
                     std::to_string(status_->plane_count) + ", idle: '" + status_->idle_reason + "'\n";
  for (const planemap_lcm::counter_t& counter : status_->counters) {
    text += "  " + counter.name + " " + std::to_string(counter.value) + "\n";
  }
  return text;
}

bool Bus::wait_until(const std::function<bool()>& condition, std::chrono::milliseconds limit) {
  const auto end = std::chrono::steady_clock::now() + limit;
  while (!condition()) {
    if (std::chrono::steady_clock::now() >= end) return false;
    lcm_.handleTimeout(20);
  }
  return true;
}

void Bus::listen_for(std::chrono::milliseconds time) {
  wait_until([] { return false; }, time);
}

}  // namespace planemap::system_test

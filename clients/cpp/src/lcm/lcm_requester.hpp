#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <lcm/lcm-cpp.hpp>
#include <memory>
#include <planemap/client/lcm_map_client.hpp>
#include <planemap/client/map_types.hpp>
#include <planemap_lcm/reply_t.hpp>
#include <planemap_lcm/request_t.hpp>
#include <string>
#include <vector>

#include "lcm/page_collector.hpp"

namespace planemap::client {

/// Sends requests and gathers the pages of their answers, on a reply channel of its own.
class LcmRequester {
 public:
  LcmRequester(std::shared_ptr<lcm::LCM> bus, const LcmClientOptions& options);
  ~LcmRequester();
  LcmRequester(const LcmRequester&) = delete;
  LcmRequester& operator=(const LcmRequester&) = delete;

  /// @param question  operation, filter and queries; epoch and revision where those of an earlier answer are meant,
  /// else
  ///                  0. The rest is set here.
  /// @return the pages, by number
  Expected<std::vector<planemap_lcm::reply_t>> ask(const planemap_lcm::request_t& question,
                                                   std::chrono::milliseconds timeout);

  lcm::LCM& bus() { return *bus_; }
  const LcmClientOptions& options() const { return options_; }
  std::size_t malformed_count() const { return malformed_; }
  /// A message could not be read.
  void note_malformed(std::string why);

 private:
  void on_reply(const lcm::ReceiveBuffer* buffer, const std::string& channel) noexcept;
  bool send(const planemap_lcm::request_t& question, std::int32_t page);
  bool begin(const planemap_lcm::request_t& question);
  bool ask_again(const planemap_lcm::request_t& question);
  tl::unexpected<Error> gave_up(std::chrono::milliseconds timeout) const;

  std::shared_ptr<lcm::LCM> bus_;
  LcmClientOptions options_;
  std::string reply_channel_;
  lcm::Subscription* subscription_ = nullptr;
  std::int64_t next_id_;
  PageCollector collector_;
  bool refused_ = false;       ///< the service answered the present request with an error
  bool contradicted_ = false;  ///< pages of the present request do not fit each other
  std::size_t malformed_ = 0;
  std::string last_malformed_;
};

}  // namespace planemap::client

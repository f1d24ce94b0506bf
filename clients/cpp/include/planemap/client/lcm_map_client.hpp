#pragma once

#include <chrono>
#include <memory>
#include <planemap/client/map_types.hpp>
#include <string>

namespace lcm {
class LCM;
}

namespace planemap::client {

/// Where the service is listening, and how patient to be with it.
struct LcmClientOptions {
  std::string request_channel = "PLANEMAP_REQUEST";
  std::chrono::milliseconds ask_again_after{1000};  ///< nothing came: the whole request is sent again
  std::chrono::milliseconds lost_page_after{200};   ///< no page for so long: the missing ones are asked for by number
};

/// The URL that is used where none is given: the environment's LCM_DEFAULT_URL, else udpm://239.255.76.67:7667?ttl=0.
std::string default_lcm_url();

/// Asks a planemap service over LCM. An answer comes as pages, each a message; lost ones are asked for again by number
/// until the answer is whole or the timeout over. Every call blocks up to its timeout. Not thread-safe: one thread uses
/// it.
class LcmMapClient {
 public:
  /// Opens LCM; a receive buffer that holds a whole answer is added to udpm URLs that name none.
  /// Fails (kNoNetwork) if it can't be opened; the error says what to do.
  static Expected<std::unique_ptr<LcmMapClient>> connect(const std::string& url, const LcmClientOptions& options = {});

  /// Uses a bus of the caller's, which nobody else may handle during calls and which must outlive the client.
  explicit LcmMapClient(std::shared_ptr<lcm::LCM> bus, const LcmClientOptions& options = {});
  ~LcmMapClient();
  LcmMapClient(const LcmMapClient&) = delete;
  LcmMapClient& operator=(const LcmMapClient&) = delete;

  Expected<Status> status(std::chrono::milliseconds timeout);
  /// All planes with their boundaries.
  Expected<Map> snapshot(std::chrono::milliseconds timeout);
  /// All dense cells. While mapping goes on their revision is a later one than that of a snapshot before: whole_map()
  /// gives both of one revision.
  Expected<Map> cells(std::chrono::milliseconds timeout);
  /// All planes and the dense cells of the same revision. Where the service does not keep the planes' revision until it
  /// is asked for the cells, both are asked for anew.
  Expected<Map> whole_map(std::chrono::milliseconds timeout);

  /// Messages on the reply channel that could not be read, so far.
  std::size_t malformed_count() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace planemap::client

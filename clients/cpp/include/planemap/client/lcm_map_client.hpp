#pragma once

#include <chrono>
#include <memory>
#include <planemap/client/wire_map_client.hpp>
#include <string>

namespace lcm {
class LCM;
}

namespace planemap::client {

class LcmRequester;

/// Where the service is listening, and how patient to be with it.
struct LcmClientOptions {
  std::string request_channel = "PLANEMAP_REQUEST";
  std::string delta_channel = "PLANEMAP_DELTA";
  std::string status_channel = "PLANEMAP_STATUS";
  std::chrono::milliseconds ask_again_after{1000};  ///< nothing came: the whole request is sent again
  std::chrono::milliseconds lost_page_after{200};   ///< no page for so long: the missing ones are asked for by number
  /// A watch: the status tells of a revision, and so long no delta to it came: the whole map is asked for.
  std::chrono::milliseconds lost_delta_after{1000};
  /// A watch that lost news: so long it may ask for the whole map, if need be beyond a call's timeout.
  std::chrono::milliseconds catch_up_for{2000};
  std::chrono::milliseconds silent_after{5000};  ///< a watch: nothing was heard for so long: the service is not there
};

/// The URL that is used where none is given: the environment's LCM_DEFAULT_URL, else udpm://239.255.76.67:7667?ttl=0.
std::string default_lcm_url();

/// Asks a planemap service over LCM. An answer comes as pages, each a message; lost ones are asked for again by number
/// until the answer is whole or the timeout over. Where the service does not keep the revision of a call's first part
/// until it is asked for the next one, whole_map(), nearest() and cast() begin anew.
class LcmMapClient final : public WireMapClient {
 public:
  /// Opens LCM; a receive buffer that holds a whole answer is added to udpm URLs that name none.
  /// Fails (kNoNetwork) if it can't be opened; the error says what to do.
  static Expected<std::unique_ptr<LcmMapClient>> connect(const std::string& url, const LcmClientOptions& options = {});

  /// Uses a bus of the caller's, which nobody else may handle during calls and which must outlive the client.
  explicit LcmMapClient(std::shared_ptr<lcm::LCM> bus, const LcmClientOptions& options = {});
  ~LcmMapClient() override;

  /// By the deltas, and by snapshots where those were lost.
  std::unique_ptr<MapWatch> watch() override;

  /// Messages on the reply channel that could not be read, so far.
  std::size_t malformed_count() const;

 private:
  Expected<std::vector<planemap_lcm::reply_t>> ask(const planemap_lcm::request_t& request, Timeout timeout) override;

  std::unique_ptr<LcmRequester> requester_;
};

}  // namespace planemap::client

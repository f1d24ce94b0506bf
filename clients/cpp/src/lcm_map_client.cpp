#include "planemap/client/lcm_map_client.hpp"

#include <cstdlib>
#include <lcm/lcm-cpp.hpp>
#include <utility>

#include "lcm/lcm_map_watch.hpp"
#include "lcm/lcm_requester.hpp"

namespace planemap::client {
namespace {

constexpr const char* kReceiveBuffer = "recv_buf_size=4194304";

std::string with_receive_buffer(const std::string& url) {
  if (url.rfind("udpm://", 0) != 0 || url.find("recv_buf_size") != std::string::npos) return url;
  return url + (url.find('?') == std::string::npos ? '?' : '&') + kReceiveBuffer;
}

}  // namespace

std::string default_lcm_url() {
  const char* url = std::getenv("LCM_DEFAULT_URL");
  return url != nullptr && *url != '\0' ? url : "udpm://239.255.76.67:7667?ttl=0";
}

Expected<std::unique_ptr<LcmMapClient>> LcmMapClient::connect(const std::string& url, const LcmClientOptions& options) {
  auto bus = std::make_shared<lcm::LCM>(with_receive_buffer(url));
  if (!bus->good()) {
    return tl::make_unexpected(
        Error{Error::Kind::kNoNetwork,
              "LCM can't be opened at " + url +
                  "; check the URL and that there is a route for multicast (ip route add 224.0.0.0/4 dev lo)"});
  }
  return std::make_unique<LcmMapClient>(std::move(bus), options);
}

LcmMapClient::LcmMapClient(std::shared_ptr<lcm::LCM> bus, const LcmClientOptions& options)
    : requester_(std::make_unique<LcmRequester>(std::move(bus), options)) {}

LcmMapClient::~LcmMapClient() = default;

Expected<std::vector<planemap_lcm::reply_t>> LcmMapClient::ask(const planemap_lcm::request_t& request,
                                                               Timeout timeout) {
  return requester_->ask(request, timeout);
}

std::unique_ptr<MapWatch> LcmMapClient::watch() {
  return std::make_unique<LcmMapWatch>(*requester_);
}

std::size_t LcmMapClient::malformed_count() const {
  return requester_->malformed_count();
}

}  // namespace planemap::client

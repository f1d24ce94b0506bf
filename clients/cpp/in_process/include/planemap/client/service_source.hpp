#pragma once

#include <planemap/client/in_process_map_client.hpp>
#include <string>

namespace planemap::service {
class Service;
}

namespace planemap::client {

/// The map of a service in this process, which must outlive what asks it.
/// @param frame  name of the world frame (map.frame)
MapSource source_of(service::Service& service, const std::string& frame);

}  // namespace planemap::client

#include "planemap/client/service_source.hpp"

#include "lcm/wire_types.hpp"
#include "service.hpp"

namespace planemap::client {

MapSource source_of(service::Service& service, const std::string& frame) {
  return {[&service] { return service.queries(); }, [&service] { return status_of(service.status()); }, frame};
}

}  // namespace planemap::client

#include "common/version.hpp"

namespace planemap::service {

const char* version() {
  return PLANEMAP_VERSION;
}

}  // namespace planemap::service

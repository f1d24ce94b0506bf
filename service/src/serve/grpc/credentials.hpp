#pragma once

#include <grpcpp/security/server_credentials.h>

#include <memory>
#include <planemap/expected.hpp>

#include "config/service_config.hpp"

namespace planemap::service {

/// TLS by the configured files, or none where no certificate is configured. Errors name the key and the file: one that
/// cannot be read or is no PEM, a key that is not the certificate's.
Expected<std::shared_ptr<grpc::ServerCredentials>> server_credentials(const GrpcConfig& config);

}  // namespace planemap::service

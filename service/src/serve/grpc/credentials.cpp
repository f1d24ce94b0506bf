#include "serve/grpc/credentials.hpp"

#include <openssl/bio.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/x509.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>
#include <string>

namespace planemap::service {
namespace {

template <class T, void (*Free)(T*)>
struct Freer {
  void operator()(T* object) const { Free(object); }
};
using Certificate = std::unique_ptr<X509, Freer<X509, X509_free>>;
using Key = std::unique_ptr<EVP_PKEY, Freer<EVP_PKEY, EVP_PKEY_free>>;
using Bytes = std::unique_ptr<BIO, Freer<BIO, BIO_free_all>>;

Bytes bytes_of(const std::string& text) {
  return Bytes(BIO_new_mem_buf(text.data(), static_cast<int>(text.size())));
}

/// No passphrase: the daemon has nobody to ask.
int no_passphrase(char*, int, int, void*) {
  return 0;
}

Expected<std::string> read_file(const char* key, const std::string& name) {
  std::ifstream file(name, std::ios::binary);
  std::ostringstream text;
  if (file) text << file.rdbuf();
  if (!file) return fail(std::string(key) + ": " + name + ": cannot be read: " + std::strerror(errno));
  return text.str();
}

Expected<Certificate> certificate_of(const char* key, const std::string& name, const std::string& text) {
  Certificate certificate(PEM_read_bio_X509(bytes_of(text).get(), nullptr, no_passphrase, nullptr));
  if (!certificate) return fail(std::string(key) + ": " + name + ": holds no certificate in PEM");
  return certificate;
}

/// gRPC would only say that it cannot listen.
Expected<void> check_pair(const GrpcConfig& config, const std::string& certificate_text, const std::string& key_text) {
  const auto certificate = certificate_of("grpc.tls_certificate", config.tls_certificate, certificate_text);
  if (!certificate) return tl::make_unexpected(certificate.error());
  const Key key(PEM_read_bio_PrivateKey(bytes_of(key_text).get(), nullptr, no_passphrase, nullptr));
  if (!key) return fail("grpc.tls_key: " + config.tls_key + ": holds no private key in PEM without a passphrase");
  if (X509_check_private_key(certificate->get(), key.get()) != 1) {
    return fail("grpc.tls_key: " + config.tls_key + ": is not the key of the certificate in " + config.tls_certificate);
  }
  if (X509_cmp_current_time(X509_get0_notAfter(certificate->get())) < 0) {
    return fail("grpc.tls_certificate: " + config.tls_certificate + ": has expired");
  }
  return {};
}

}  // namespace

Expected<std::shared_ptr<grpc::ServerCredentials>> server_credentials(const GrpcConfig& config) {
  if (config.tls_certificate.empty()) return grpc::InsecureServerCredentials();
  auto certificate = read_file("grpc.tls_certificate", config.tls_certificate);
  if (!certificate) return tl::make_unexpected(certificate.error());
  auto key = read_file("grpc.tls_key", config.tls_key);
  if (!key) return tl::make_unexpected(key.error());
  if (auto fits = check_pair(config, *certificate, *key); !fits) return tl::make_unexpected(fits.error());
  grpc::SslServerCredentialsOptions options(config.tls_client_ca.empty()
                                                ? GRPC_SSL_DONT_REQUEST_CLIENT_CERTIFICATE
                                                : GRPC_SSL_REQUEST_AND_REQUIRE_CLIENT_CERTIFICATE_AND_VERIFY);
  options.pem_key_cert_pairs.push_back({*key, *certificate});
  if (!config.tls_client_ca.empty()) {
    auto client_ca = read_file("grpc.tls_client_ca", config.tls_client_ca);
    if (!client_ca) return tl::make_unexpected(client_ca.error());
    const auto is_pem = certificate_of("grpc.tls_client_ca", config.tls_client_ca, *client_ca);
    if (!is_pem) return tl::make_unexpected(is_pem.error());
    options.pem_root_certs = *client_ca;
  }
  return grpc::SslServerCredentials(options);
}

}  // namespace planemap::service

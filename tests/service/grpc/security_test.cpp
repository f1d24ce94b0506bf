// TLS and tokens over real connections, with certificates made by openssl in the test's own folder.

#include <planemap/test/health.grpc.pb.h>

#include "serve/grpc/call_guard.hpp"
#include "support/certificates.hpp"
#include "support/temporary_folder.hpp"
#include "test_daemon.hpp"

namespace planemap::service {
namespace {

using grpc::StatusCode;

constexpr const char* kReader = "reader-0123456789abcdef";
constexpr const char* kAdmin = "admin-0123456789abcdef";

class Tls : public testing::Test {
 protected:
  static void SetUpTestSuite() { certificates_ = std::make_unique<Certificates>(); }
  static void TearDownTestSuite() { certificates_.reset(); }

  static ServiceConfig config() {
    auto config = test_config();
    config.grpc.tls_certificate = certificates_->path("server.crt");
    config.grpc.tls_key = certificates_->path("server.key");
    return config;
  }
  /// How GetStatus ends for a client that trusts an authority and shows a certificate (empty: none).
  static grpc::Status ask(const TestDaemon& daemon, const std::string& authority, const std::string& shown = {}) {
    grpc::SslCredentialsOptions options;
    options.pem_root_certs = certificates_->text(authority + ".crt");
    if (!shown.empty()) {
      options.pem_cert_chain = certificates_->text(shown + ".crt");
      options.pem_private_key = certificates_->text(shown + ".key");
    }
    const auto stub =
        v1::PlaneMap::NewStub(grpc::CreateChannel(daemon.server().address(), grpc::SslCredentials(options)));
    v1::GetStatusResponse response;
    return stub->GetStatus(new_context().get(), {}, &response);
  }
  static std::string problem_of(const ServiceConfig& config) {
    try {
      const TestDaemon daemon(config);
    } catch (const std::runtime_error& e) {
      return e.what();
    }
    return "none";
  }

  static std::unique_ptr<Certificates> certificates_;
};
std::unique_ptr<Certificates> Tls::certificates_;

TEST_F(Tls, ClientsThatTrustTheAuthorityAreServed) {
  const TestDaemon daemon(config());
  const auto status = ask(daemon, "ca");
  EXPECT_TRUE(status.ok()) << status.error_message();
}

TEST_F(Tls, OthersAreNot) {
  const TestDaemon daemon(config());
  EXPECT_EQ(ask(daemon, "other-ca").error_code(), StatusCode::UNAVAILABLE);
  v1::GetStatusResponse response;
  EXPECT_EQ(daemon.stub()->GetStatus(new_context().get(), {}, &response).error_code(), StatusCode::UNAVAILABLE);
}

TEST_F(Tls, ClientCertificatesAreAskedForWhereAnAuthorityIsNamed) {
  auto with_clients = config();
  with_clients.grpc.tls_client_ca = certificates_->path("ca.crt");
  const TestDaemon daemon(with_clients);
  const auto status = ask(daemon, "ca", "client");
  EXPECT_TRUE(status.ok()) << status.error_message();
  EXPECT_EQ(ask(daemon, "ca").error_code(), StatusCode::UNAVAILABLE);
  EXPECT_EQ(ask(daemon, "ca", "stranger").error_code(), StatusCode::UNAVAILABLE);
}

TEST_F(Tls, OffTheLoopbackThereIsNoPlainServer) {
  auto plain = test_config();
  plain.grpc.listen = "0.0.0.0:0";
  EXPECT_EQ(problem_of(plain), "grpc.listen: 0.0.0.0:0 can be reached from other machines: it needs TLS");
}

TEST_F(Tls, FilesThatCannotBeUsedAreNamed) {
  const auto& folder = certificates_->folder();
  auto wrong = config();
  wrong.grpc.tls_certificate = certificates_->path("missing.crt");
  EXPECT_EQ(problem_of(wrong),
            "grpc.tls_certificate: " + wrong.grpc.tls_certificate + ": cannot be read: No such file or directory");
  wrong = config();
  wrong.grpc.tls_certificate = certificates_->path("server.key");
  EXPECT_EQ(problem_of(wrong), "grpc.tls_certificate: " + wrong.grpc.tls_certificate + ": holds no certificate in PEM");
  wrong = config();
  wrong.grpc.tls_key = certificates_->path("server.crt");
  EXPECT_EQ(problem_of(wrong),
            "grpc.tls_key: " + wrong.grpc.tls_key + ": holds no private key in PEM without a passphrase");
  wrong = config();
  wrong.grpc.tls_key = certificates_->path("client.key");
  EXPECT_EQ(problem_of(wrong), "grpc.tls_key: " + wrong.grpc.tls_key + ": is not the key of the certificate in " +
                                   wrong.grpc.tls_certificate);
  wrong = config();
  wrong.grpc.tls_client_ca = (folder / "empty.crt").string();
  folder.write("empty.crt", "");
  EXPECT_EQ(problem_of(wrong), "grpc.tls_client_ca: " + wrong.grpc.tls_client_ca + ": holds no certificate in PEM");
}

class Tokens : public testing::Test {
 protected:
  Tokens() {
    folder_.write("tokens", std::string("# who may what\nread ") + kReader + "\nadmin " + kAdmin + "\n");
    auto config = test_config();
    config.grpc.token_file = (folder_ / "tokens").string();
    daemon_ = std::make_unique<TestDaemon>(config);
  }
  static std::unique_ptr<grpc::ClientContext> context_with(const std::string& authorization) {
    auto context = new_context();
    if (!authorization.empty()) context->AddMetadata("authorization", authorization);
    return context;
  }
  grpc::Status read_with(const std::string& authorization) {
    v1::GetStatusResponse response;
    return daemon_->stub()->GetStatus(context_with(authorization).get(), {}, &response);
  }
  grpc::Status pause_with(const std::string& authorization) {
    v1::PauseResponse response;
    return daemon_->admin()->Pause(context_with(authorization).get(), {}, &response);
  }

  TemporaryFolder folder_;
  std::unique_ptr<TestDaemon> daemon_;
};

TEST_F(Tokens, AreNeededForEveryCall) {
  expect_error(read_with(""), StatusCode::UNAUTHENTICATED,
               "this call needs a token of scope read: send 'authorization: Bearer TOKEN'");
  expect_error(pause_with(""), StatusCode::UNAUTHENTICATED, "this call needs a token of scope admin");
  const auto stub = daemon_->stub();
  expect_error(read_all(*stub->Watch(new_context().get(), {})).second, StatusCode::UNAUTHENTICATED, "scope read");
  expect_error(read_all(*stub->GetSnapshot(new_context().get(), {})).second, StatusCode::UNAUTHENTICATED, "scope read");
  EXPECT_EQ(daemon_->counter("grpc.calls.failed.unauthenticated"), 4);
}

TEST_F(Tokens, UnknownOnesAreRefused) {
  expect_error(read_with("Bearer reader-0123456789abcdeX"), StatusCode::UNAUTHENTICATED, "the token is not known");
  expect_error(read_with(std::string("Basic ") + kReader), StatusCode::UNAUTHENTICATED, "the token is not known");
  expect_error(read_with("Bearer "), StatusCode::UNAUTHENTICATED, "the token is not known");
}

TEST_F(Tokens, HaveAScope) {
  const std::string reader = std::string("Bearer ") + kReader;
  const std::string admin = std::string("Bearer ") + kAdmin;
  EXPECT_TRUE(read_with(reader).ok());
  expect_error(pause_with(reader), StatusCode::PERMISSION_DENIED, "the token is of scope read, this call needs admin");
  EXPECT_FALSE(daemon_->service().mapping().is_paused());
  EXPECT_TRUE(read_with(admin).ok());
  EXPECT_TRUE(pause_with(admin).ok());
  EXPECT_TRUE(daemon_->service().mapping().is_paused());
}

TEST_F(Tokens, AreNotNeededForHealth) {
  grpc::health::v1::HealthCheckResponse response;
  EXPECT_TRUE(grpc::health::v1::Health::NewStub(daemon_->channel())->Check(new_context().get(), {}, &response).ok());
}

TEST(TokenFile, ProblemsNameTheLineAndNeverTheToken) {
  const TemporaryFolder folder;
  const std::string name = (folder / "tokens").string();
  const std::pair<const char*, const char*> cases[] = {
      {"write 0123456789abcdef\n", ":1: a line must begin with a scope: read or admin"},
      {"\nread\n", ":2: a line must have a scope and one token"},
      {"read 0123456789abcdef more\n", ":1: a line must have a scope and one token"},
      {"read secret\n", ":1: a token must have 16 printable ASCII characters or more"},
      {"read 0123456789abcdef\nadmin 0123456789abcdef\n", ":2: this token stands in an earlier line, too"},
      {"# nothing\n", ": has no token"},
  };
  for (const auto& [text, problem] : cases) {
    folder.write("tokens", text);
    const auto guard = CallGuard::from_file(name);
    ASSERT_FALSE(guard) << text;
    EXPECT_EQ(guard.error().message, "grpc.token_file: " + name + problem);
  }
  const auto missing = CallGuard::from_file(name + "x");
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().message, "grpc.token_file: " + name + "x: cannot be read: No such file or directory");
}

TEST(CallGuard, WithoutTokensAdminIsForTheLoopback) {
  const CallGuard guard;
  for (const char* peer : {"ipv4:127.0.0.1:4711", "ipv4:127.8.9.1:1", "ipv6:%5B::1%5D:4711", "ipv6:[::1]:4711",
                           "ipv6:%5B::ffff:127.0.0.1%5D:4711"}) {
    EXPECT_EQ(guard.check(Scope::kAdmin, "", peer).denial, Denial::kNone) << peer;
  }
  for (const char* peer : {"ipv4:10.0.0.1:4711", "ipv6:%5B2001:db8::1%5D:4711", "ipv6:%5B::ffff:10.0.0.1%5D:4711", "",
                           "unix:", "ipv4:127.0.0.1.example.org:1"}) {
    const auto verdict = guard.check(Scope::kAdmin, "", peer);
    EXPECT_EQ(verdict.denial, Denial::kPermissionDenied) << peer;
    EXPECT_NE(verdict.message.find("this call needs a token of scope admin"), std::string::npos);
    EXPECT_EQ(guard.check(Scope::kRead, "", peer).denial, Denial::kNone) << peer;
  }
}

}  // namespace
}  // namespace planemap::service

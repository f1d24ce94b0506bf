#pragma once

#include <stdexcept>
#include <string>

#include "support/process.hpp"
#include "support/temporary_folder.hpp"

namespace planemap {

/// A folder with two authorities (ca, other-ca), and certificates that they signed: server for localhost and 127.0.0.1,
/// client by the first, stranger by the second. Made by openssl.
class Certificates {
 public:
  Certificates() {
    make_authority("ca");
    make_authority("other-ca");
    sign("server", "ca", "subjectAltName=DNS:localhost,IP:127.0.0.1");
    sign("client", "ca", "extendedKeyUsage=clientAuth");
    sign("stranger", "other-ca", "extendedKeyUsage=clientAuth");
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::string text(const std::string& name) const { return read_file(folder_ / name); }
  const TemporaryFolder& folder() const { return folder_; }

 private:
  void run(const std::string& arguments) {
    const auto result =
        run_in_shell("sh -c 'cd " + folder_.path().string() + " && openssl " + arguments + "'", folder_.path());
    if (result.exit_code != 0) throw std::runtime_error("openssl " + arguments + ": " + result.err);
  }
  void make_authority(const std::string& name) {
    run("req -x509 -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes -days 2 -subj /CN=" + name + " -keyout " +
        name + ".key -out " + name + ".crt");
  }
  void sign(const std::string& name, const std::string& authority, const std::string& extension) {
    folder_.write(name + ".ext", extension + "\n");
    run("req -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes -subj /CN=" + name + " -keyout " + name +
        ".key -out " + name + ".csr");
    run("x509 -req -days 2 -in " + name + ".csr -CA " + authority + ".crt -CAkey " + authority +
        ".key -CAcreateserial -extfile " + name + ".ext -out " + name + ".crt");
  }

  TemporaryFolder folder_;
};

}  // namespace planemap

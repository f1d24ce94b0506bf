#include "serve/http/assets.hpp"

#include <zlib.h>

#include <memory>
#include <string>
#include <string_view>
#include <utility>

namespace planemap::service {
namespace {

/// The bundler puts a hash of the content in the names of what is here.
constexpr std::string_view kHashedFolder = "/assets/";
constexpr std::string_view kLicenses = "/licenses.txt";

std::string unpacked(const Asset& asset) {
  constexpr int kGzipWindow = 15 + 16;
  std::string out(asset.bytes, '\0');
  z_stream stream{};
  if (inflateInit2(&stream, kGzipWindow) != Z_OK) return {};
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(asset.gzip));  // zlib does not write there
  stream.avail_in = static_cast<uInt>(asset.gzip_bytes);
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  inflate(&stream, Z_FINISH);
  inflateEnd(&stream);
  return out;
}

std::optional<HttpAnswer> answer_at(std::string_view path, const HttpRequest& request) {
  for (const Asset& asset : embedded_assets()) {
    if (path != asset.path) continue;
    HttpAnswer answer;
    answer.content_type = asset.content_type;
    answer.etag = asset.etag;
    answer.may_be_kept = path.starts_with(kHashedFolder);
    answer.is_gzip = request.accepts_gzip;
    answer.body = std::make_shared<const std::string>(request.accepts_gzip ? std::string(asset.gzip, asset.gzip_bytes)
                                                                           : unpacked(asset));
    return unless_known(std::move(answer), request);
  }
  return std::nullopt;
}

}  // namespace

std::optional<HttpAnswer> asset_answer(const HttpRequest& request) {
  return answer_at(request.path == "/" ? "/index.html" : request.path, request);
}

HttpAnswer license_answer(const HttpRequest& request) {
  if (auto answer = answer_at(kLicenses, request)) return std::move(*answer);
  return answer_of("text/plain; charset=utf-8", "The page of this build bundles no code of others.\n");
}

}  // namespace planemap::service

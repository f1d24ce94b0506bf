#include "map_stream.hpp"

#include <memory>
#include <optional>
#include <utility>

#include "deadline.hpp"
#include "proto_answers.hpp"

namespace planemap::client {
namespace {

using std::chrono::milliseconds;

/// The pages of one answer, one after the other.
template <class Page>
class PageReader {
 public:
  /// @param open  (context) -> the call's reader
  template <class Open>
  PageReader(GrpcChannel& channel, milliseconds timeout, const Open& open) : channel_(channel), timeout_(timeout) {
    channel.prepare(context_, timeout);
    reader_ = open(&context_);
  }
  ~PageReader() {
    if (!reader_) return;
    context_.TryCancel();
    reader_->Finish();
  }
  PageReader(const PageReader&) = delete;
  PageReader& operator=(const PageReader&) = delete;

  /// The next page; nullptr: there is no more. Fails where the call does, and where pages don't belong together.
  Expected<const Page*> next() {
    const bool is_there = reader_ != nullptr && reader_->Read(&page_);
    if (!is_there && is_last_) return last();
    if (!is_there) return tl::make_unexpected(end());
    MapVersion version;
    const bool fits = !is_last_ && page_.page() == count_ && read(page_.map(), version) &&
                      (count_ == 0 || (version.epoch == version_.epoch && version.revision == version_.revision));
    if (!fits) return malformed("a page of the answer");
    version_ = version;
    ++count_;
    is_last_ = page_.last();
    return &page_;
  }
  /// Of the pages so far.
  const MapVersion& version() const { return version_; }

 private:
  grpc::Status finish() { return std::exchange(reader_, nullptr)->Finish(); }

  Expected<const Page*> last() {
    const grpc::Status status = reader_ != nullptr ? finish() : grpc::Status::OK;
    if (!status.ok()) return tl::make_unexpected(channel_.error_of(status, timeout_));
    return nullptr;
  }

  Error end() {
    const grpc::Status status = finish();
    if (status.ok()) return malformed("the last page of the answer").value();
    Error error = channel_.error_of(status, timeout_);
    if (count_ == 0 || error.kind != Error::Kind::kUnreachable) return error;
    return {Error::Kind::kIncomplete,
            "the answer came in part only (" + std::to_string(count_) + " pages); then " + error.message};
  }

  GrpcChannel& channel_;
  const milliseconds timeout_;
  grpc::ClientContext context_;
  std::unique_ptr<grpc::ClientReader<Page>> reader_;
  Page page_;
  MapVersion version_;
  std::uint32_t count_ = 0;
  bool is_last_ = false;
};

using SnapshotReader = PageReader<v1::SnapshotPage>;
using CellsReader = PageReader<v1::CellsPage>;

auto open_snapshot(GrpcChannel& channel) {
  return [&channel](grpc::ClientContext* context) { return channel.plane_map().GetSnapshot(context, {}); };
}

auto open_cells(GrpcChannel& channel) {
  return [&channel](grpc::ClientContext* context) { return channel.plane_map().GetCells(context, {}); };
}

bool add(const v1::SnapshotPage& page, Map& map) {
  map.frame = page.frame();
  return read_all(page.planes(), map.planes);
}

bool add(const v1::CellsPage& page, Map& map) {
  map.frame = page.frame();
  return read_all(page.cells(), map.cells);
}

bool add(const v1::RegionPage& page, RegionAnswer& answer) {
  return read_all(page.planes(), answer.planes) && read_all(page.cells(), answer.cells);
}

/// Adds a page, if there is one, and all after it.
template <class Page, class Answer>
Expected<void> add_pages(PageReader<Page>& reader, Expected<const Page*> page, Answer& answer) {
  for (;; page = reader.next()) {
    if (!page) return tl::make_unexpected(page.error());
    if (*page == nullptr) return {};
    if (!add(**page, answer)) return malformed("a plane or a cell");
  }
}

template <class Page>
Expected<Map> read_map(PageReader<Page>&& reader) {
  Map map;
  if (auto added = add_pages(reader, reader.next(), map); !added) return tl::make_unexpected(added.error());
  map.epoch = reader.version().epoch;
  map.revision = reader.version().revision;
  return map;
}

/// Planes and cells, asked for at once; nothing where the map changed between the two.
Expected<std::optional<Map>> try_whole_map(GrpcChannel& channel, milliseconds timeout) {
  SnapshotReader planes(channel, timeout, open_snapshot(channel));
  CellsReader cells(channel, timeout, open_cells(channel));
  const auto first_planes = planes.next();
  if (!first_planes) return tl::make_unexpected(first_planes.error());
  const auto first_cells = cells.next();
  if (!first_cells) return tl::make_unexpected(first_cells.error());
  const MapVersion& version = planes.version();
  if (version.epoch != cells.version().epoch || version.revision != cells.version().revision) return std::nullopt;
  Map map;
  auto added = add_pages(planes, first_planes, map).and_then([&] { return add_pages(cells, first_cells, map); });
  if (!added) return tl::make_unexpected(added.error());
  map.epoch = version.epoch;
  map.revision = version.revision;
  return map;
}

}  // namespace

tl::unexpected<Error> malformed(const std::string& what) {
  return tl::make_unexpected(
      Error{Error::Kind::kMalformed, "the service's answer cannot be used: " + what + " is not sound"});
}

Expected<Map> read_snapshot(GrpcChannel& channel, milliseconds timeout) {
  return read_map(SnapshotReader(channel, timeout, open_snapshot(channel)));
}

Expected<Map> read_cells(GrpcChannel& channel, milliseconds timeout) {
  return read_map(CellsReader(channel, timeout, open_cells(channel)));
}

Expected<Map> read_whole_map(GrpcChannel& channel, milliseconds timeout) {
  const Deadline deadline(timeout);
  bool is_first = true;
  do {
    auto map = try_whole_map(channel, deadline.left());
    if (!map && !is_first && deadline.is_over()) break;  // the time ran out on a later try
    if (!map) return tl::make_unexpected(map.error());
    if (*map) return std::move(**map);
    is_first = false;
  } while (!deadline.is_over());
  return incomplete(
      "the map changed faster than its planes and cells could be asked for; there were no two of one revision",
      timeout);
}

Expected<RegionAnswer> read_region(GrpcChannel& channel, const v1::QueryRegionRequest& request, milliseconds timeout) {
  PageReader<v1::RegionPage> reader(channel, timeout, [&](grpc::ClientContext* context) {
    return channel.plane_map().QueryRegion(context, request);
  });
  RegionAnswer answer;
  if (auto added = add_pages(reader, reader.next(), answer); !added) return tl::make_unexpected(added.error());
  answer.version = reader.version();
  return answer;
}

}  // namespace planemap::client

#include "store/backup_writer.hpp"

#include <spdlog/spdlog.h>

#include "common/background.hpp"
#include "store/map_reader.hpp"

namespace planemap::service {
namespace {

constexpr int kNice = 10;  ///< the mapper goes first, then the saver

}  // namespace

BackupWriter::BackupWriter(const std::filesystem::path& path, Counters& counters)
    : path_(path), counters_(counters), thread_([this](const std::stop_token& stop) { run(stop); }) {}

BackupWriter::~BackupWriter() {
  stop();
}

void BackupWriter::begin() {
  {
    const std::lock_guard lock(mutex_);
    wanted_ = true;
  }
  changed_.notify_all();
}

void BackupWriter::stop() {
  if (!thread_.joinable()) return;
  thread_.request_stop();
  thread_.join();
}

void BackupWriter::run(const std::stop_token& stop) {
  run_in_background(kNice);
  for (;;) {
    {
      std::unique_lock lock(mutex_);
      if (!changed_.wait(lock, stop, [this] { return wanted_; })) return;
      wanted_ = false;
    }
    if (stop.stop_requested()) return;
    write(stop);
  }
}

void BackupWriter::write(const std::stop_token& stop) {
  try {
    // Not by way of open_database(), which looks into the file itself: a process that closes any descriptor of a file
    // loses all its locks on it, also those of SQLite's other connections.
    Database database(path_, Database::Access::kRead);
    auto done = copy_database(database, path_.string() + ".backup", stop);
    if (done && !*done) return;
    counters_.add(done ? "store.backups" : "store.backup_failures");
    if (!done) spdlog::warn("{}", done.error().message);
  } catch (const std::exception& error) {
    counters_.add("store.backup_failures");
    spdlog::warn("{}: the backup cannot be written: {}", path_.string(), error.what());
  }
}

}  // namespace planemap::service

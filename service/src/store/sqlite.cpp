#include "store/sqlite.hpp"

#include <sqlite3.h>

#include <utility>

namespace planemap::service {
namespace {

constexpr int kBusyMs = 2000;
constexpr int kPagesOfASlice = 256;

[[noreturn]] void complain(sqlite3* database, int code) {
  std::string message = database != nullptr ? sqlite3_errmsg(database) : sqlite3_errstr(code);
  throw SqliteError(code, message);
}

void expect(sqlite3* database, int code) {
  if (code != SQLITE_OK) complain(database, code);
}

}  // namespace

bool SqliteError::is_damage() const {
  const int primary = code_ & 0xff;
  // What damaged tables make of statements that are right: no such table, wrong types, constraints that do not hold.
  return primary == SQLITE_CORRUPT || primary == SQLITE_NOTADB || primary == SQLITE_ERROR ||
         primary == SQLITE_CONSTRAINT || primary == SQLITE_MISMATCH || primary == SQLITE_TOOBIG ||
         primary == SQLITE_SCHEMA || primary == SQLITE_FORMAT || code_ == SQLITE_IOERR_SHORT_READ;
}

void Statement::Finalize::operator()(sqlite3_stmt* statement) const {
  sqlite3_finalize(statement);
}

Statement::Statement(sqlite3* database, const std::string& sql) : database_(database) {
  sqlite3_stmt* statement = nullptr;
  expect(database_, sqlite3_prepare_v2(database_, sql.c_str(), static_cast<int>(sql.size()), &statement, nullptr));
  statement_.reset(statement);
}

Statement& Statement::bind(int at, std::int64_t value) {
  expect(database_, sqlite3_bind_int64(statement_.get(), at, value));
  return *this;
}

Statement& Statement::bind(int at, std::span<const std::uint8_t> blob) {
  expect(database_, sqlite3_bind_blob64(statement_.get(), at, blob.data(), blob.size(), SQLITE_STATIC));
  return *this;
}

Statement& Statement::bind(int at, const std::string& text) {
  expect(database_, sqlite3_bind_text(statement_.get(), at, text.data(), static_cast<int>(text.size()), SQLITE_STATIC));
  return *this;
}

bool Statement::step() {
  const int code = sqlite3_step(statement_.get());
  if (code == SQLITE_ROW) return true;
  if (code == SQLITE_DONE) return false;
  sqlite3_reset(statement_.get());
  complain(database_, code);
}

void Statement::run() {
  while (step()) {
  }
  sqlite3_reset(statement_.get());
}

std::int64_t Statement::integer(int column) const {
  return sqlite3_column_int64(statement_.get(), column);
}

std::string Statement::text(int column) const {
  const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(statement_.get(), column));
  return text == nullptr ? ""
                         : std::string(text, static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column)));
}

std::span<const std::uint8_t> Statement::blob(int column) const {
  const auto* bytes = static_cast<const std::uint8_t*>(sqlite3_column_blob(statement_.get(), column));
  return {bytes, bytes == nullptr ? 0 : static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column))};
}

void Database::Close::operator()(sqlite3* database) const {
  sqlite3_close_v2(database);
}

Database::Database(const std::filesystem::path& path, Access access) {
  int flags = access == Access::kRead ? SQLITE_OPEN_READONLY : SQLITE_OPEN_READWRITE;
  if (access == Access::kCreate) flags |= SQLITE_OPEN_CREATE;
  sqlite3* handle = nullptr;
  const int code = sqlite3_open_v2(path.c_str(), &handle,
                                   flags | SQLITE_OPEN_URI | SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_EXRESCODE, nullptr);
  handle_.reset(handle);
  expect(handle, code);
  sqlite3_busy_timeout(handle, kBusyMs);
  // The file may be anybody's: no code in its schema is run, and its views and triggers are not trusted.
  sqlite3_db_config(handle, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  sqlite3_db_config(handle, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  sqlite3_limit(handle, SQLITE_LIMIT_LENGTH, 64 << 20);
}

void Database::execute(const std::string& sql) {
  expect(handle_.get(), sqlite3_exec(handle_.get(), sql.c_str(), nullptr, nullptr, nullptr));
}

std::string Database::answer(const std::string& sql) {
  Statement statement = prepare(sql);
  return statement.step() ? statement.text(0) : "";
}

bool Database::copy_to(const std::filesystem::path& path, const std::stop_token& stop) {
  std::filesystem::remove(path);
  Database target(path, Access::kCreate);
  // The read transaction keeps all slices of one state: without it each commit of another would begin the copy anew.
  execute("BEGIN");
  answer("SELECT count(*) FROM sqlite_master");
  sqlite3_backup* backup = sqlite3_backup_init(target.handle_.get(), "main", handle_.get(), "main");
  if (backup == nullptr) complain(target.handle_.get(), sqlite3_errcode(target.handle_.get()));
  int code = SQLITE_OK;
  while (code == SQLITE_OK && !stop.stop_requested()) code = sqlite3_backup_step(backup, kPagesOfASlice);
  sqlite3_backup_finish(backup);
  execute("COMMIT");
  if (code == SQLITE_OK) return false;
  if (code != SQLITE_DONE) complain(target.handle_.get(), code);
  target.execute("PRAGMA journal_mode=DELETE");  // one file, that can be read where nothing can be written
  return true;
}

}  // namespace planemap::service

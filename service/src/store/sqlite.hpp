#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <stdexcept>
#include <stop_token>
#include <string>

struct sqlite3;
struct sqlite3_stmt;

namespace planemap::service {

/// What SQLite may have beside a database, in names that begin with its own.
constexpr const char* kSqliteSuffixes[] = {"-wal", "-shm", "-journal"};

/// What SQLite could not do.
class SqliteError : public std::runtime_error {
 public:
  SqliteError(int code, const std::string& message) : std::runtime_error(message), code_(code) {}
  int code() const { return code_; }
  /// The file is none of SQLite's, or not as SQLite left it; else the system failed (disk full, read-only, ...).
  bool is_damage() const;

 private:
  int code_;
};

/// A prepared statement. Bound blobs and texts must live until step() has ended. Throws SqliteError.
class Statement {
 public:
  Statement(sqlite3* database, const std::string& sql);

  Statement& bind(int at, std::int64_t value);
  Statement& bind(int at, std::span<const std::uint8_t> blob);
  Statement& bind(int at, const std::string& text);
  /// @return whether there is a row
  bool step();
  /// Runs it to its end, and makes it ready for other values.
  void run();

  std::int64_t integer(int column) const;
  std::string text(int column) const;
  std::span<const std::uint8_t> blob(int column) const;  ///< valid until the next step

 private:
  struct Finalize {
    void operator()(sqlite3_stmt* statement) const;
  };
  sqlite3* database_;
  std::unique_ptr<sqlite3_stmt, Finalize> statement_;
};

/// A connection; one thread uses it at a time. Throws SqliteError.
class Database {
 public:
  enum class Access { kCreate, kWrite, kRead };
  Database(const std::filesystem::path& path, Access access);

  Statement prepare(const std::string& sql) { return {handle_.get(), sql}; }
  void execute(const std::string& sql);
  std::string answer(const std::string& sql);  ///< first column of the first row; empty: no row
  /// Copies all of it as it is now into another file, which is written anew: SQLite's backup, consistent while others
  /// write.
  /// @param stop  ends it before it is done
  /// @return whether it is done
  bool copy_to(const std::filesystem::path& path, const std::stop_token& stop = {});

 private:
  struct Close {
    void operator()(sqlite3* database) const;
  };
  std::unique_ptr<sqlite3, Close> handle_;
};

}  // namespace planemap::service

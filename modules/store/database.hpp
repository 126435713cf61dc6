#pragma once

#include <concepts>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "core/error.hpp"

struct sqlite3;
struct sqlite3_stmt;

namespace concord {

/// One SQL statement, compiled once and run many times. Parameters are `?`, bound in order; columns count from 0.
class Statement {
 public:
  /// Starts anew with these parameters: integers (as int64), double, text, bytes (std::span<const std::uint8_t>).
  /// Text and bytes are copied.
  template <class... Values>
  Statement& bind(const Values&... values) {
    reset();
    int index = 0;
    (bind_one(++index, values), ...);
    return *this;
  }

  /// Fetches the next row: true if there is one, false at the end.
  [[nodiscard]] Result<bool> step();

  /// Calls `visit()` for each row that is left.
  template <class Visit>
  [[nodiscard]] Result<void> for_each_row(Visit&& visit) {
    for (;;) {
      const Result<bool> row = step();
      if (!row) return tl::unexpected(row.error());
      if (!*row) return {};
      visit();
    }
  }

  /// For statements that answer no rows: binds, runs to the end, and is ready for the next time.
  template <class... Values>
  [[nodiscard]] Result<void> run(const Values&... values) {
    bind(values...);
    return finish();
  }

  /// Columns of the row that step() fetched. Bytes are valid until the next call on this statement.
  [[nodiscard]] std::int64_t integer(int column) const;
  [[nodiscard]] double real(int column) const;
  [[nodiscard]] std::string text(int column) const;
  [[nodiscard]] std::span<const std::uint8_t> bytes(int column) const;

  /// Lets go of the rows not fetched; a statement left in their midst keeps its read open.
  void reset();

 private:
  friend class Database;
  struct Finalize {
    void operator()(sqlite3_stmt* statement) const;
  };

  explicit Statement(sqlite3_stmt* statement) : statement_(statement) {}

  template <std::integral Int>
  void bind_one(int index, Int value) {
    bind_integer(index, static_cast<std::int64_t>(value));
  }
  void bind_one(int index, double value);
  void bind_one(int index, std::string_view value);
  void bind_one(int index, const std::string& value) { bind_one(index, std::string_view(value)); }
  void bind_one(int index, const char* value) { bind_one(index, std::string_view(value)); }
  void bind_one(int index, std::span<const std::uint8_t> value);
  void bind_integer(int index, std::int64_t value);
  void note(int status);
  [[nodiscard]] Result<void> finish();

  std::unique_ptr<sqlite3_stmt, Finalize> statement_;
  int bind_status_ = 0;  ///< the first binding that failed; told by step()
};

/// One SQLite file that one process owns: in WAL, synced at every commit, locked against a second owner.
class Database {
 public:
  /// Opens or creates `file` and its folder. `migrations[i]` is SQL that brings schema i to i + 1; the missing ones
  /// are applied in one transaction.
  /// @throws std::runtime_error if the file cannot be used (says why): no folder, read-only, in use by another
  /// process, not a database, or written by a newer version.
  Database(const std::filesystem::path& file, std::span<const char* const> migrations);

  /// @throws std::runtime_error for SQL that does not fit the schema; so prepare at start-up.
  [[nodiscard]] Statement prepare(const std::string& sql);

  /// Runs SQL without parameters and rows.
  [[nodiscard]] Result<void> execute(const std::string& sql);

 private:
  friend class Transaction;
  struct Close {
    void operator()(sqlite3* database) const;
  };

  void migrate(std::span<const char* const> migrations);

  std::filesystem::path file_;
  std::unique_ptr<sqlite3, Close> handle_;
  std::optional<Statement> begin_, commit_;  ///< compiled once, there after the start
};

/// All or nothing: what runs between begin and commit is on disk after commit() succeeded, or is undone.
class Transaction {
 public:
  [[nodiscard]] static Result<Transaction> begin(Database& database);
  Transaction(Transaction&& other) noexcept : database_(std::exchange(other.database_, nullptr)) {}
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  Transaction& operator=(Transaction&&) = delete;
  ~Transaction();

  [[nodiscard]] Result<void> commit();

 private:
  explicit Transaction(Database& database) : database_(&database) {}

  Database* database_;  ///< null once over
};

}  // namespace concord

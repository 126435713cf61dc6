#include "store/database.hpp"

#include <sqlite3.h>

#include <cassert>
#include <stdexcept>
#include <system_error>

namespace concord {
namespace {

constexpr int kBusyMilliseconds = 2000;  // a supervisor may start the next owner while the last one is closing

tl::unexpected<Error> failure(sqlite3* handle, int status) {
  const char* file = handle != nullptr ? sqlite3_db_filename(handle, "main") : nullptr;
  std::string message = sqlite3_errmsg(handle);
  switch (status & 0xFF) {
    case SQLITE_FULL: message += "; free some space"; break;
    case SQLITE_READONLY:
    case SQLITE_CANTOPEN:
    case SQLITE_PERM: message += "; make the file and its folder writable"; break;
    case SQLITE_BUSY: message += "; another process owns it, end that one first"; break;
    case SQLITE_NOTADB:
    case SQLITE_CORRUPT: message += "; move the file away and bring back a backup"; break;
    default: break;
  }
  return refuse(Code::kIo, std::string(file != nullptr ? file : "database") + ": " + message);
}

template <class T>
void require(const Result<T>& result) {
  if (!result) throw std::runtime_error(result.error().message);
}

}  // namespace

void Statement::Finalize::operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }

void Statement::note(int status) {
  assert(status != SQLITE_RANGE && status != SQLITE_MISUSE);
  if (bind_status_ == SQLITE_OK) bind_status_ = status;
}

void Statement::bind_integer(int index, std::int64_t value) {
  note(sqlite3_bind_int64(statement_.get(), index, value));
}

void Statement::bind_one(int index, double value) { note(sqlite3_bind_double(statement_.get(), index, value)); }

void Statement::bind_one(int index, std::string_view value) {
  // A null pointer would be bound as NULL; an empty text is a text.
  const char* data = value.data() != nullptr ? value.data() : "";
  note(sqlite3_bind_text64(statement_.get(), index, data, value.size(), SQLITE_TRANSIENT, SQLITE_UTF8));
}

void Statement::bind_one(int index, std::span<const std::uint8_t> value) {
  const void* data = value.data() != nullptr ? static_cast<const void*>(value.data()) : "";
  note(sqlite3_bind_blob64(statement_.get(), index, data, value.size(), SQLITE_TRANSIENT));
}

Result<bool> Statement::step() {
  const int status = bind_status_ == SQLITE_OK ? sqlite3_step(statement_.get()) : bind_status_;
  if (status == SQLITE_ROW) return true;
  if (status == SQLITE_DONE) return false;
  return failure(sqlite3_db_handle(statement_.get()), status);
}

Result<void> Statement::finish() {
  const Result<bool> row = step();
  assert(!row || !*row);
  reset();
  if (!row) return tl::unexpected(row.error());
  return {};
}

std::int64_t Statement::integer(int column) const { return sqlite3_column_int64(statement_.get(), column); }

double Statement::real(int column) const { return sqlite3_column_double(statement_.get(), column); }

std::string Statement::text(int column) const {
  const auto* data = reinterpret_cast<const char*>(sqlite3_column_text(statement_.get(), column));
  return data != nullptr ? std::string(data, sqlite3_column_bytes(statement_.get(), column)) : std::string();
}

std::span<const std::uint8_t> Statement::bytes(int column) const {
  const auto* data = static_cast<const std::uint8_t*>(sqlite3_column_blob(statement_.get(), column));
  return {data, static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column))};
}

void Statement::reset() {
  sqlite3_reset(statement_.get());  // repeats the last step's status, which step() told
  sqlite3_clear_bindings(statement_.get());
  bind_status_ = SQLITE_OK;
}

void Database::Close::operator()(sqlite3* database) const { sqlite3_close_v2(database); }

Database::Database(const std::filesystem::path& file, std::span<const char* const> migrations) : file_(file) {
  if (file.has_parent_path()) {
    std::error_code error;
    std::filesystem::create_directories(file.parent_path(), error);
    if (error) throw std::runtime_error(file.parent_path().string() + ": cannot make this folder: " + error.message());
  }
  sqlite3* handle = nullptr;
  const int status = sqlite3_open_v2(file.c_str(), &handle, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, nullptr);
  handle_.reset(handle);
  if (status != SQLITE_OK) throw std::runtime_error(failure(handle, status).value().message);
  sqlite3_extended_result_codes(handle, 1);
  sqlite3_busy_timeout(handle, kBusyMilliseconds);
  // Exclusive: two processes that both believed to own the state would each overwrite what the other acknowledged.
  require(
      execute("PRAGMA locking_mode = EXCLUSIVE; PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL;"
              "PRAGMA foreign_keys = ON; PRAGMA journal_size_limit = 16777216;"));
  begin_.emplace(prepare("BEGIN IMMEDIATE"));
  commit_.emplace(prepare("COMMIT"));
  migrate(migrations);
}

void Database::migrate(std::span<const char* const> migrations) {
  // Writing at once, even when nothing is missing, finds a file that can only be read before anything relies on it.
  Result<Transaction> transaction = Transaction::begin(*this);
  require(transaction);
  std::int64_t version = 0;
  {
    Statement read = prepare("PRAGMA user_version");
    require(read.step());
    version = read.integer(0);
  }
  if (version < 0 || static_cast<std::size_t>(version) > migrations.size()) {
    throw std::runtime_error(file_.string() + ": has schema " + std::to_string(version) + ", this program knows " +
                             std::to_string(migrations.size()) + "; run a newer version of it");
  }
  for (const char* sql : migrations.subspan(static_cast<std::size_t>(version))) require(execute(sql));
  require(execute("PRAGMA user_version = " + std::to_string(migrations.size())));
  require(transaction->commit());
}

Statement Database::prepare(const std::string& sql) {
  sqlite3_stmt* statement = nullptr;
  const int status = sqlite3_prepare_v3(handle_.get(), sql.c_str(), -1, SQLITE_PREPARE_PERSISTENT, &statement, nullptr);
  if (status != SQLITE_OK) throw std::runtime_error(failure(handle_.get(), status).value().message + ": " + sql);
  return Statement(statement);
}

Result<void> Database::execute(const std::string& sql) {
  const int status = sqlite3_exec(handle_.get(), sql.c_str(), nullptr, nullptr, nullptr);
  if (status != SQLITE_OK) return failure(handle_.get(), status);
  return {};
}

Result<Transaction> Transaction::begin(Database& database) {
  const Result<void> begun = database.begin_->run();
  if (!begun) return tl::unexpected(begun.error());
  return Transaction(database);
}

Transaction::~Transaction() {
  // SQLite has rolled back by itself after some failures (a full disk); then there is nothing left to undo.
  if (database_ == nullptr || sqlite3_get_autocommit(database_->handle_.get()) != 0) return;
  sqlite3_exec(database_->handle_.get(), "ROLLBACK", nullptr, nullptr, nullptr);
}

Result<void> Transaction::commit() {
  assert(database_ != nullptr);
  const Result<void> done = database_->commit_->run();
  if (done) database_ = nullptr;
  return done;
}

}  // namespace concord

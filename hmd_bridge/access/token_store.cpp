#include "access/token_store.hpp"

#include <openssl/evp.h>
#include <openssl/rand.h>
#include <sqlite3.h>

#include <algorithm>
#include <array>
#include <memory>
#include <stdexcept>

#include "core/requests.hpp"
#include "store/database.hpp"

namespace concord::hmd {
namespace {

constexpr const char* kMigrations[] = {
    "CREATE TABLE tokens (name TEXT PRIMARY KEY, hash TEXT NOT NULL UNIQUE, role INTEGER NOT NULL, created INTEGER NOT "
    "NULL)"};
constexpr std::size_t kMaxToken = 200;

struct Close {
  void operator()(sqlite3* handle) const { sqlite3_close(handle); }
};
struct Finalize {
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};

std::string sha256(const std::string& text) {
  std::array<unsigned char, 32> hash;
  unsigned size = 0;
  if (EVP_Digest(text.data(), text.size(), hash.data(), &size, EVP_sha256(), nullptr) != 1)
    throw std::runtime_error("no SHA-256");
  static constexpr char kHex[] = "0123456789abcdef";
  std::string out;
  for (const unsigned char byte : hash) {
    out += kHex[byte >> 4];
    out += kHex[byte & 15];
  }
  return out;
}

/// Runs `use` on the opened store; what SQLite says becomes a refusal.
template <class Use>
auto with(const std::filesystem::path& file, Use use) -> decltype(use(std::declval<Database&>())) {
  try {
    Database database(file, kMigrations);
    return use(database);
  } catch (const std::runtime_error& e) {
    const std::string what = e.what();
    const bool busy = what.find("another process") != std::string::npos;
    return concord::refuse(busy ? concord::Code::kBusy : concord::Code::kIo, what);
  }
}

}  // namespace

std::string random_secret() {
  std::array<unsigned char, 32> bytes;
  if (RAND_bytes(bytes.data(), static_cast<int>(bytes.size())) != 1)
    throw std::runtime_error("the system gives no random bytes");
  static constexpr char kLetters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
  std::string text;
  unsigned bits = 0, held = 0;
  for (const unsigned char byte : bytes) {
    held = held << 8 | byte;
    for (bits += 8; bits >= 6; bits -= 6) text += kLetters[held >> (bits - 6) & 63];
  }
  return text + kLetters[held << (6 - bits) & 63];
}

Result<std::string> TokenStore::add(const std::string& name, Role role, std::int64_t now) {
  if (!is_name(name)) return concord::refuse(concord::Code::kBadName, "a token's name is 1 to 40 of A-Z a-z 0-9 . _ -");
  return with(file_, [&](Database& database) -> Result<std::string> {
    Statement count = database.prepare("SELECT COUNT(*), SUM(name = ?) FROM tokens");
    const auto row = count.bind(name).step();
    if (!row) return tl::unexpected(row.error());
    if (count.integer(0) >= static_cast<std::int64_t>(kMost))
      return concord::refuse(concord::Code::kTooLarge, "there are 1000 tokens; remove some");
    if (count.integer(1) > 0)
      return concord::refuse(concord::Code::kExists, "there is a token " + name + "; remove it first");
    count.reset();
    std::string token = "concord_" + random_secret();
    Statement insert = database.prepare("INSERT INTO tokens VALUES (?, ?, ?, ?)");
    const auto done = insert.run(name, sha256(token), static_cast<std::int64_t>(role), now);
    if (!done) return tl::unexpected(done.error());
    return token;
  });
}

Result<void> TokenStore::remove(const std::string& name) {
  return with(file_, [&](Database& database) -> Result<void> {
    Statement find = database.prepare("SELECT 1 FROM tokens WHERE name = ?");
    const auto row = find.bind(name).step();
    if (!row) return tl::unexpected(row.error());
    if (!*row) return concord::refuse(concord::Code::kNotFound, "no token is called " + name);
    find.reset();
    return database.prepare("DELETE FROM tokens WHERE name = ?").run(name);
  });
}

Result<std::vector<TokenStore::Entry>> TokenStore::list() {
  return with(file_, [&](Database& database) -> Result<std::vector<Entry>> {
    std::vector<Entry> entries;
    Statement all = database.prepare("SELECT name, role, created FROM tokens ORDER BY name");
    all.bind();
    const auto read = all.for_each_row([&] {
      entries.push_back({all.text(0), static_cast<Role>(std::min<std::int64_t>(2, all.integer(1))), all.integer(2)});
    });
    if (!read) return tl::unexpected(read.error());
    return entries;
  });
}

Result<std::optional<Identity>> TokenStore::find(const std::string& token) {
  if (token.size() > kMaxToken) return std::optional<Identity>();
  return look_up(sha256(token));
}

Result<bool> TokenStore::holds(const Identity& who) {
  return look_up(who.token).map([&](const std::optional<Identity>& now) { return now == who; });
}

// Anybody may ask whether a token is one: this writes nothing and waits for nobody.
Result<std::optional<Identity>> TokenStore::look_up(const std::string& hash) {
  std::error_code ignored;
  if (!std::filesystem::exists(file_, ignored)) return std::optional<Identity>();
  sqlite3* opened = nullptr;
  int status = sqlite3_open_v2(file_.c_str(), &opened, SQLITE_OPEN_READWRITE, nullptr);
  const std::unique_ptr<sqlite3, Close> handle(opened);
  sqlite3_stmt* prepared = nullptr;
  constexpr const char* kQuery = "SELECT name, role FROM tokens WHERE hash = ?";
  if (status == SQLITE_OK) status = sqlite3_prepare_v2(handle.get(), kQuery, -1, &prepared, nullptr);
  const std::unique_ptr<sqlite3_stmt, Finalize> find(prepared);
  if (status == SQLITE_OK)
    status = sqlite3_bind_text(find.get(), 1, hash.data(), static_cast<int>(hash.size()), SQLITE_TRANSIENT);
  if (status == SQLITE_OK) status = sqlite3_step(find.get());
  if (status == SQLITE_DONE) return std::optional<Identity>();
  if (status != SQLITE_ROW) {
    const bool busy = (status & 0xFF) == SQLITE_BUSY;
    return concord::refuse(busy ? concord::Code::kBusy : concord::Code::kIo, sqlite3_errstr(status));
  }
  const std::int64_t role = sqlite3_column_int64(find.get(), 1);
  if (role < 0 || role > 2) return concord::refuse(concord::Code::kMalformed, "a token in the store has no role");
  const auto* name = reinterpret_cast<const char*>(sqlite3_column_text(find.get(), 0));
  return std::optional(Identity{name != nullptr ? name : "", static_cast<Role>(role), hash});
}

}  // namespace concord::hmd

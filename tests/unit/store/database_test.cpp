#include "store/database.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <fstream>
#include <functional>
#include <limits>
#include <stdexcept>
#include <vector>

namespace concord {
namespace {

namespace fs = std::filesystem;

constexpr std::array<const char*, 1> kFirst = {"CREATE TABLE item (id INTEGER PRIMARY KEY, name TEXT NOT NULL)"};
constexpr std::array<const char*, 2> kSecond = {kFirst[0], "ALTER TABLE item ADD COLUMN weight REAL DEFAULT 1.5"};

class DatabaseTest : public ::testing::Test {
 protected:
  DatabaseTest() {
    std::string pattern = (fs::temp_directory_path() / "concord-store-XXXXXX").string();
    folder_ = ::mkdtemp(pattern.data());
    file_ = folder_ / "state.db";
  }
  ~DatabaseTest() override {
    fs::permissions(folder_, fs::perms::owner_all);
    fs::remove_all(folder_);
  }

  fs::path folder_, file_;
};

std::int64_t count(Database& database) {
  Statement statement = database.prepare("SELECT count(*) FROM item");
  EXPECT_TRUE(statement.step().value());
  return statement.integer(0);
}

/// Runs `body` in a process of its own; its answer is the exit code.
int in_child(const std::function<int()>& body) {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(body());
  int status = 0;
  EXPECT_EQ(::waitpid(child, &status, 0), child);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

std::string why(const std::function<void()>& body) {
  try {
    body();
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST_F(DatabaseTest, values_of_every_type_come_back) {
  constexpr std::array<const char*, 1> kSchema = {
      "CREATE TABLE v (i INTEGER, d REAL, t TEXT NOT NULL, b BLOB NOT NULL)"};
  Database database(file_, kSchema);
  Statement insert = database.prepare("INSERT INTO v VALUES (?, ?, ?, ?)");
  const std::vector<std::uint8_t> bytes = {0, 255, 0, 1};
  ASSERT_TRUE(insert.run(std::numeric_limits<std::int64_t>::min(), 0.1, "a\nb", bytes));
  ASSERT_TRUE(insert.run(7, -1.0, std::string(), std::vector<std::uint8_t>()));

  Statement select = database.prepare("SELECT i, d, t, b FROM v ORDER BY rowid");
  ASSERT_TRUE(select.step().value());
  EXPECT_EQ(select.integer(0), std::numeric_limits<std::int64_t>::min());
  EXPECT_EQ(select.real(1), 0.1);
  EXPECT_EQ(select.text(2), "a\nb");
  EXPECT_EQ(std::vector<std::uint8_t>(select.bytes(3).begin(), select.bytes(3).end()), bytes);
  ASSERT_TRUE(select.step().value());
  EXPECT_EQ(select.integer(0), 7);
  EXPECT_EQ(select.text(2), "");
  EXPECT_TRUE(select.bytes(3).empty());
  EXPECT_FALSE(select.step().value());

  std::vector<std::int64_t> integers;
  ASSERT_TRUE(select.bind().for_each_row([&] { integers.push_back(select.integer(0)); }));
  EXPECT_EQ(integers, (std::vector<std::int64_t>{std::numeric_limits<std::int64_t>::min(), 7}));
}

TEST_F(DatabaseTest, what_was_not_committed_is_undone) {
  Database database(file_, kFirst);
  Statement insert = database.prepare("INSERT INTO item VALUES (?, ?)");
  {
    auto transaction = Transaction::begin(database);
    ASSERT_TRUE(transaction);
    ASSERT_TRUE(insert.run(1, "lost"));
  }
  EXPECT_EQ(count(database), 0);
  auto transaction = Transaction::begin(database);
  ASSERT_TRUE(transaction);
  ASSERT_TRUE(insert.run(1, "kept"));
  ASSERT_TRUE(transaction->commit());
  EXPECT_EQ(count(database), 1);
}

TEST_F(DatabaseTest, a_refused_row_is_told_and_the_statement_stays_usable) {
  Database database(file_, kFirst);
  Statement insert = database.prepare("INSERT INTO item VALUES (?, ?)");
  ASSERT_TRUE(insert.run(1, "a"));
  const Result<void> again = insert.run(1, "b");
  ASSERT_FALSE(again);
  EXPECT_EQ(again.error().code, Code::kIo);
  EXPECT_NE(again.error().message.find("UNIQUE"), std::string::npos) << again.error().message;
  EXPECT_TRUE(insert.run(2, "b"));
}

TEST_F(DatabaseTest, a_kill_amid_a_transaction_leaves_what_was_committed) {
  const int died = in_child([&] {
    Database database(file_, kFirst);
    Statement insert = database.prepare("INSERT INTO item VALUES (?, ?)");
    if (!insert.run(1, "acknowledged")) return 1;
    auto transaction = Transaction::begin(database);
    for (int i = 2; i < 5000; ++i) {
      if (!insert.run(i, std::string(1000, 'x'))) return 1;
    }
    return ::kill(::getpid(), SIGKILL);
  });
  ASSERT_EQ(died, -SIGKILL);
  Database database(file_, kFirst);
  EXPECT_EQ(count(database), 1);
}

TEST_F(DatabaseTest, later_migrations_keep_the_rows) {
  { EXPECT_TRUE(Database(file_, kFirst).execute("INSERT INTO item VALUES (1, 'old')")); }
  { Database again(file_, kFirst); }
  Database database(file_, kSecond);
  Statement select = database.prepare("SELECT name, weight FROM item");
  ASSERT_TRUE(select.step().value());
  EXPECT_EQ(select.text(0), "old");
  EXPECT_EQ(select.real(1), 1.5);
}

TEST_F(DatabaseTest, a_failing_migration_changes_nothing) {
  { Database database(file_, kFirst); }
  constexpr std::array<const char*, 3> kBroken = {kFirst[0], kSecond[1], "CREATE TABLE item (id INTEGER)"};
  EXPECT_NE(why([&] { Database database(file_, kBroken); }).find("already exists"), std::string::npos);
  EXPECT_EQ(why([&] { Database database(file_, kSecond); }), "");
}

TEST_F(DatabaseTest, a_newer_schema_is_refused) {
  { Database database(file_, kSecond); }
  EXPECT_NE(why([&] { Database database(file_, kFirst); }).find("newer version"), std::string::npos);
}

TEST_F(DatabaseTest, a_second_owner_is_refused) {
  Database database(file_, kFirst);
  EXPECT_EQ(in_child([&] {
              return why([&] { Database second(file_, kFirst); }).find("another process") == std::string::npos;
            }),
            0);
}

TEST_F(DatabaseTest, a_folder_that_cannot_be_written_is_told_at_start) {
  { Database database(file_, kFirst); }
  fs::permissions(file_, fs::perms::all);
  fs::permissions(folder_,
                  fs::perms::owner_read | fs::perms::owner_exec | fs::perms::others_read | fs::perms::others_exec);
  const int code = in_child([&] {
    if (::geteuid() == 0 && ::seteuid(65534) != 0) return 2;  // root may write anywhere
    return why([&] { Database database(file_, kFirst); }).find("writable") == std::string::npos ? 1 : 0;
  });
  EXPECT_EQ(code, 0);
  const int missing = in_child([&] {
    if (::geteuid() == 0 && ::seteuid(65534) != 0) return 2;
    return why([&] { Database database(folder_ / "sub" / "x.db", kFirst); }).find("folder") == std::string::npos ? 1
                                                                                                                 : 0;
  });
  EXPECT_EQ(missing, 0);
}

TEST_F(DatabaseTest, what_is_no_database_is_refused) {
  std::ofstream(file_) << std::string(5000, 'x');
  EXPECT_NE(why([&] { Database database(file_, kFirst); }).find("not a database"), std::string::npos);
}

TEST_F(DatabaseTest, a_full_disk_is_told_and_nothing_is_half_written) {
  Database database(file_, kFirst);
  ASSERT_TRUE(database.execute("PRAGMA max_page_count = 20"));
  Statement insert = database.prepare("INSERT INTO item VALUES (?, ?)");
  Result<void> result;
  {
    auto transaction = Transaction::begin(database);
    for (int i = 0; i < 1000 && result; ++i) result = insert.run(i, std::string(1000, 'x'));
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().code, Code::kIo);
    EXPECT_NE(result.error().message.find("full"), std::string::npos) << result.error().message;
  }
  EXPECT_EQ(count(database), 0);
  EXPECT_TRUE(insert.run(1, "small"));
}

}  // namespace
}  // namespace concord

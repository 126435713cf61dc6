#include "cli/supervisor.hpp"

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>

#include <gtest/gtest.h>

#include "cli/stack.hpp"

namespace concord {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

bool is_gone(pid_t pid) { return kill(pid, 0) != 0; }

/// Lets the supervisor work until `done`, at most ten seconds.
template <class Done>
bool wait_until(Supervisor& supervisor, Done done) {
  const auto end = Supervisor::Clock::now() + seconds(10);
  while (!done() && Supervisor::Clock::now() < end) supervisor.wait(milliseconds(100));
  return done();
}

class SupervisorTest : public testing::Test {
 protected:
  std::vector<std::string> said;
  Supervisor supervisor{[this](const std::string& line) { said.push_back(line); }};

  pid_t start(const std::string& name, std::vector<std::string> command, bool restart = true) {
    const auto started = supervisor.start({name, std::move(command), {}, restart});
    EXPECT_TRUE(started) << started.error().message;
    return supervisor.pid(name);
  }
};

TEST_F(SupervisorTest, StartsAKilledChildAgainAndSaysSo) {
  const pid_t first = start("child", {"sleep", "1000"});
  kill(first, SIGKILL);
  ASSERT_TRUE(wait_until(supervisor, [&] { return supervisor.restarts("child") == 1; }));
  EXPECT_NE(supervisor.pid("child"), first);
  EXPECT_FALSE(is_gone(supervisor.pid("child")));
  ASSERT_EQ(said.size(), 1U);
  EXPECT_NE(said[0].find("child was ended by signal 9"), std::string::npos) << said[0];
}

TEST_F(SupervisorTest, PausesLongerEachTime) {
  start("child", {"false"});
  ASSERT_TRUE(wait_until(supervisor, [&] { return said.size() == 3; }));
  EXPECT_NE(said[0].find("again in 200 ms"), std::string::npos);
  EXPECT_NE(said[1].find("again in 400 ms"), std::string::npos);
  EXPECT_NE(said[2].find("again in 800 ms"), std::string::npos);
}

TEST_F(SupervisorTest, GivesUpOnAConfigurationThatCannotBeUsed) {
  start("child", {"sh", "-c", "exit 2"});
  ASSERT_TRUE(wait_until(supervisor, [&] { return supervisor.unusable().has_value(); }));
  EXPECT_EQ(supervisor.unusable(), "child");
  EXPECT_EQ(supervisor.restarts("child"), 0);
}

TEST_F(SupervisorTest, LetsAChildThatMayEndDoSo) {
  start("child", {"sh", "-c", "exit 7"}, false);
  ASSERT_TRUE(wait_until(supervisor, [&] { return supervisor.exit_code("child").has_value(); }));
  EXPECT_EQ(supervisor.exit_code("child"), 7);
  EXPECT_EQ(supervisor.restarts("child"), 0);
}

TEST_F(SupervisorTest, RefusesAProgramThatIsNotThere) {
  const auto started = supervisor.start({"child", {"/no/such/program"}, {}, true});
  ASSERT_FALSE(started);
  EXPECT_EQ(started.error().code, Code::kIo);
  EXPECT_EQ(supervisor.pid("child"), 0);
}

TEST_F(SupervisorTest, LeavesNothingBehind) {
  int held[2];  // by every process below us: it ends with the last of them
  ASSERT_EQ(pipe(held), 0);
  const pid_t plain = start("plain", {"sleep", "1000"});
  const pid_t parent = start("parent", {"sh", "-c", "sleep 1000 & wait"});
  close(held[1]);
  supervisor.stop();
  EXPECT_TRUE(is_gone(plain));
  EXPECT_TRUE(is_gone(parent));
  char nothing = 0;
  EXPECT_EQ(read(held[0], &nothing, 1), 0);
  close(held[0]);
}

TEST_F(SupervisorTest, KillsAChildThatDoesNotWantToGo) {
  const auto ready = std::filesystem::path(testing::TempDir()) / ("deaf" + std::to_string(getpid()));
  const pid_t deaf =
      start("deaf", {"sh", "-c", "trap '' TERM; : >" + ready.string() + "; while :; do read x </dev/zero; done"});
  ASSERT_TRUE(wait_until(supervisor, [&] { return std::filesystem::exists(ready); }));
  supervisor.stop("deaf");
  EXPECT_TRUE(is_gone(deaf));
  EXPECT_EQ(supervisor.exit_code("deaf"), 128 + SIGKILL);
  std::filesystem::remove(ready);
}

TEST(SupervisorDeath, EndsTheChildrenOfASupervisorThatWasKilled) {
  int channel[2];
  ASSERT_EQ(pipe(channel), 0);
  const pid_t host = fork();
  if (host == 0) {
    Supervisor supervisor([](const std::string&) {});
    const bool started = supervisor.start({"child", {"sleep", "1000"}, {}, true}).has_value();
    const pid_t child = started ? supervisor.pid("child") : 0;
    [[maybe_unused]] const ssize_t written = write(channel[1], &child, sizeof(child));
    pause();
    _exit(0);
  }
  pid_t child = 0;
  ASSERT_EQ(read(channel[0], &child, sizeof(child)), static_cast<ssize_t>(sizeof(child)));
  ASSERT_GT(child, 0);
  close(channel[1]);
  kill(host, SIGKILL);
  waitpid(host, nullptr, 0);
  // The child held the other end of our pipe only if it outlived exec; the kernel's word is its disappearance.
  const auto end = Supervisor::Clock::now() + seconds(10);
  const auto is_running = [child] {
    std::ifstream in("/proc/" + std::to_string(child) + "/stat");
    std::string pid, name, state;
    return static_cast<bool>(in >> pid >> name >> state) && state != "Z";
  };
  while (is_running() && Supervisor::Clock::now() < end) sched_yield();
  EXPECT_FALSE(is_running());
}

class StateLockTest : public testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove_all(state); }

  const std::filesystem::path state = std::filesystem::path(testing::TempDir()) / ("state" + std::to_string(getpid()));
};

TEST_F(StateLockTest, ASecondStackStartsNothing) {
  const auto first = FileLock::take(state / "lock", "held");
  ASSERT_TRUE(first);
  Supervisor supervisor([](const std::string&) {});
  const auto second =
      start_stack(supervisor, {.site_file = {}, .lcm_url = "", .state = state, .log = {}, .output = {}});
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, Code::kBusy);
  EXPECT_NE(second.error().message.find("a stack runs on the state folder " + state.string()), std::string::npos);
  EXPECT_EQ(not_started(second.error()).value().exit, Exit::kRefused);
  EXPECT_EQ(supervisor.pid("ingest"), 0);
}

TEST_F(StateLockTest, IsFreeOnceItsHolderWasKilled) {
  int channel[2];
  ASSERT_EQ(pipe(channel), 0);
  const pid_t host = fork();
  if (host == 0) {
    const auto lock = FileLock::take(state / "lock", "held");
    Supervisor supervisor([](const std::string&) {});
    const bool ready = lock && supervisor.start({"child", {"sleep", "1000"}, {}, true});
    [[maybe_unused]] const ssize_t written = write(channel[1], &ready, sizeof(ready));
    pause();
    _exit(0);
  }
  bool ready = false;
  ASSERT_EQ(read(channel[0], &ready, sizeof(ready)), static_cast<ssize_t>(sizeof(ready)));
  ASSERT_TRUE(ready);
  EXPECT_FALSE(FileLock::take(state / "lock", "held"));
  kill(host, SIGKILL);
  waitpid(host, nullptr, 0);
  EXPECT_TRUE(FileLock::take(state / "lock", "held"));
  close(channel[0]);
  close(channel[1]);
}

}  // namespace
}  // namespace concord

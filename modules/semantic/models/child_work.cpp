#include "semantic/models/child_work.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <new>
#include <string>
#include <utility>

namespace concord {
namespace {

/// Who waits for a disk uses no processor time, but is not waited for for ever.
constexpr unsigned kMostSeconds = 2 * kMaxModelSeconds;

void limit(int what, std::uint64_t most) {
  const rlimit value{most, most};
  (void)setrlimit(static_cast<__rlimit_resource_t>(what), &value);  // without it the caps of the work still hold
}

/// A Result as bytes for the pipe: one byte, 0 or 1 + the code of an error, then the bytes or the words.
Bytes reply_of(const Result<Bytes>& result) {
  Bytes out;
  out.reserve(1 + (result ? result->size() : result.error().message.size()));
  out.push_back(result ? std::uint8_t{0} : static_cast<std::uint8_t>(1 + static_cast<int>(result.error().code)));
  if (result) {
    out.insert(out.end(), result->begin(), result->end());
  } else {
    out.insert(out.end(), result.error().message.begin(), result.error().message.end());
  }
  return out;
}

/// @pre not empty.
Result<Bytes> result_of(Bytes reply) {
  const int code = reply[0] - 1;
  reply.erase(reply.begin());
  if (code < 0) return reply;
  if (code > static_cast<int>(Code::kIo)) return refuse(Code::kMalformed, "the model cannot be read");
  reply.resize(std::min<std::size_t>(reply.size(), 300));
  return refuse(static_cast<Code>(code), std::string(reply.begin(), reply.end()));
}

bool write_all(int to, ByteSpan bytes) {
  while (!bytes.empty()) {
    const ssize_t done = write(to, bytes.data(), bytes.size());
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(done));
  }
  return true;
}

/// The other process: does the work, says what came of it, and ends without looking back.
[[noreturn]] void work_and_tell(const ChildWork::Work& work, int to, pid_t parent) {
  (void)prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(1);
  for (const int signal : {SIGSEGV, SIGABRT, SIGFPE, SIGBUS, SIGILL, SIGINT, SIGTERM, SIGPIPE, SIGALRM})
    (void)std::signal(signal, SIG_DFL);
#if !defined(__SANITIZE_ADDRESS__)  // whose shadow is more than any limit
  limit(RLIMIT_AS, kMaxModelMemory);
#endif
  limit(RLIMIT_CPU, kMaxModelSeconds);
  limit(RLIMIT_CORE, 0);
  (void)alarm(kMostSeconds);
  (void)std::freopen("/dev/null", "w", stderr);
  Bytes reply;
  try {
    reply = reply_of(work());
  } catch (const std::bad_alloc&) {
    reply = reply_of(refuse(Code::kTooLarge, "the model takes too much memory; simplify it"));
  } catch (const std::exception& error) {
    reply = reply_of(refuse(Code::kMalformed, std::string("the model cannot be read: ") + error.what()));
  }
  _exit(write_all(to, reply) ? 0 : 1);
}

}  // namespace

Result<ChildWork> ChildWork::begin(const Work& work) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) return refuse(Code::kIo, std::string("no pipe: ") + std::strerror(errno));
  const pid_t parent = getpid();
  const pid_t child = fork();
  if (child == 0) {
    close(ends[0]);
    work_and_tell(work, ends[1], parent);
  }
  close(ends[1]);
  if (child < 0) {
    close(ends[0]);
    return refuse(Code::kIo, std::string("no process to read the model: ") + std::strerror(errno));
  }
  (void)fcntl(ends[0], F_SETFL, O_NONBLOCK);
  return ChildWork(child, ends[0]);
}

ChildWork::ChildWork(pid_t child, int from) : child_(child), from_(from) {}

ChildWork::ChildWork(ChildWork&& other) noexcept
    : child_(std::exchange(other.child_, 0)), from_(std::exchange(other.from_, -1)), reply_(std::move(other.reply_)) {}

ChildWork::~ChildWork() {
  if (from_ >= 0) close(from_);
  if (child_ <= 0) return;
  (void)kill(child_, SIGKILL);
  while (waitpid(child_, nullptr, 0) < 0 && errno == EINTR) {
  }
}

/// What has come by now; false: it has said all that it will.
bool ChildWork::read_more() {
  std::uint8_t chunk[1 << 16];
  while (reply_.size() <= kMostReply) {
    const ssize_t got = read(from_, chunk, sizeof(chunk));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) return true;
    if (got <= 0) return false;
    reply_.insert(reply_.end(), chunk, chunk + got);
  }
  return false;
}

Result<Bytes> ChildWork::end() {
  if (reply_.size() > kMostReply) (void)kill(child_, SIGKILL);
  int status = 0;
  while (waitpid(child_, &status, 0) < 0 && errno == EINTR) {
  }
  child_ = 0;
  const int signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  if (signal == SIGXCPU || signal == SIGALRM || signal == SIGKILL) {
    return refuse(Code::kTooLarge, "the model takes too long; simplify it");
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0 || reply_.empty()) {
    return refuse(Code::kMalformed, "the model cannot be read");
  }
  return result_of(std::move(reply_));
}

std::optional<Result<Bytes>> ChildWork::poll() {
  if (child_ <= 0 || read_more()) return std::nullopt;
  return end();
}

Result<Bytes> ChildWork::wait() {
  while (read_more()) {
    pollfd readable{from_, POLLIN, 0};
    (void)::poll(&readable, 1, 1000);
  }
  return end();
}

}  // namespace concord

#include "semantic/models/model_file.hpp"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <new>

#include "semantic/models/model_reader.hpp"

namespace concord {
namespace {

namespace fs = std::filesystem;

/// What the other process sends: one byte, 0 for a mesh or 1 + the code of an error, then the mesh or the words.
constexpr std::size_t kMostReply = 1 + 16 + 3 * kMaxModelTriangles * 24 + kMaxModelTriangles * 12;

Result<Bytes> read_file(const fs::path& file) {
  std::error_code error;
  const auto size = fs::file_size(file, error);
  if (error) return refuse(Code::kNotFound, file.string() + ": " + error.message());
  if (size > kMaxModelBytes) return refuse(Code::kTooLarge, file.string() + " is too large; simplify the model");
  std::ifstream in(file, std::ios::binary);
  Bytes bytes(size);
  if (!in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size))) {
    return refuse(Code::kIo, "cannot read " + file.string());
  }
  return bytes;
}

/// Refuses what leads out of the folder, by its name or by a link.
Result<Bytes> read_sibling(const fs::path& folder, const std::string& name) {
  const fs::path relative(name);
  const bool leads_out = relative.is_absolute() || std::ranges::find(relative, fs::path("..")) != relative.end();
  std::error_code error;
  const fs::path top = fs::canonical(folder, error);
  const fs::path real = error || leads_out ? fs::path() : fs::canonical(folder / relative, error);
  const auto [end_of_top, ignored] = std::mismatch(top.begin(), top.end(), real.begin(), real.end());
  if (leads_out || error || end_of_top != top.end()) {
    return refuse(Code::kNotFound, name + " is not in the model's folder");
  }
  return read_file(real);
}

void limit(int what, std::uint64_t most) {
  const rlimit value{most, most};
  (void)setrlimit(static_cast<__rlimit_resource_t>(what), &value);  // without it the caps of read_model still hold
}

/// A Result as bytes for the pipe.
Bytes reply_of(const Result<TriangleMesh>& mesh) {
  const Bytes content = mesh ? to_bytes(*mesh) : Bytes(mesh.error().message.begin(), mesh.error().message.end());
  Bytes out;
  out.reserve(1 + content.size());
  out.push_back(mesh ? std::uint8_t{0} : static_cast<std::uint8_t>(1 + static_cast<int>(mesh.error().code)));
  out.insert(out.end(), content.begin(), content.end());
  return out;
}

Result<TriangleMesh> mesh_of(ByteSpan reply) {
  if (reply[0] == 0) return mesh_from_bytes(reply.subspan(1));
  const int code = reply[0] - 1;
  if (code > static_cast<int>(Code::kIo)) return refuse(Code::kMalformed, "the model cannot be read");
  const ByteSpan words = reply.subspan(1, std::min<std::size_t>(reply.size() - 1, 300));
  return refuse(static_cast<Code>(code), std::string(words.begin(), words.end()));
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

/// The other process: reads the model, says what came of it, and ends without looking back.
[[noreturn]] void read_and_tell(const Bytes& bytes, const fs::path& file, const std::string& kind, int to) {
  for (const int signal : {SIGSEGV, SIGABRT, SIGFPE, SIGBUS, SIGILL, SIGINT, SIGTERM})
    (void)std::signal(signal, SIG_DFL);
#if !defined(__SANITIZE_ADDRESS__)  // whose shadow is more than any limit
  limit(RLIMIT_AS, kMaxModelMemory);
#endif
  limit(RLIMIT_CPU, kMaxModelSeconds);
  limit(RLIMIT_CORE, 0);
  (void)std::freopen("/dev/null", "w", stderr);
  Bytes reply;
  try {
    const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
    reply = reply_of(read_model(bytes, kind, [&](const std::string& name) { return read_sibling(folder, name); }));
  } catch (const std::bad_alloc&) {
    reply = reply_of(refuse(Code::kTooLarge, "the model takes too much memory; simplify it"));
  } catch (const std::exception& error) {
    reply = reply_of(refuse(Code::kMalformed, std::string("the model cannot be read: ") + error.what()));
  }
  _exit(write_all(to, reply) ? 0 : 1);
}

Bytes read_all(int from) {
  Bytes out;
  Bytes chunk(1 << 16);
  for (;;) {
    const ssize_t got = read(from, chunk.data(), chunk.size());
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0 || out.size() + static_cast<std::size_t>(got) > kMostReply) return out;
    out.insert(out.end(), chunk.begin(), chunk.begin() + got);
  }
}

}  // namespace

Result<TriangleMesh> read_model_file(const fs::path& file) {
  std::string kind = file.extension().string();
  if (!kind.empty()) kind.erase(0, 1);
  std::ranges::transform(kind, kind.begin(),
                         [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  if (!is_model_kind(kind))
    return refuse(Code::kBadName, file.string() + ": a model must be .glb, .gltf, .obj, .stl or .ply");
  const auto bytes = read_file(file);
  if (!bytes) return tl::unexpected(bytes.error());

  int ends[2];
  if (pipe(ends) != 0) return refuse(Code::kIo, std::string("no pipe: ") + std::strerror(errno));
  const pid_t child = fork();
  if (child == 0) read_and_tell(*bytes, file, kind, ends[1]);
  close(ends[1]);
  const Bytes reply = child > 0 ? read_all(ends[0]) : Bytes{};
  close(ends[0]);
  if (child < 0) return refuse(Code::kIo, std::string("no process to read the model: ") + std::strerror(errno));
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (WIFSIGNALED(status) && (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGKILL)) {
    return refuse(Code::kTooLarge, file.string() + ": reading the model takes too long; simplify it");
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0 || reply.empty()) {
    return refuse(Code::kMalformed, file.string() + ": the model cannot be read");
  }
  auto mesh = mesh_of(reply);
  if (!mesh) return refuse(mesh.error().code, file.string() + ": " + mesh.error().message);
  return mesh;
}

}  // namespace concord

#include "store/whole_file.hpp"

#include <cerrno>
#include <cstring>
#include <string>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace concord {
namespace {

class Descriptor {
 public:
  Descriptor(const std::filesystem::path& path, int flags) : fd_(::open(path.c_str(), flags | O_CLOEXEC, 0644)) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  [[nodiscard]] int get() const { return fd_; }
  [[nodiscard]] bool close() { return ::close(std::exchange(fd_, -1)) == 0; }

 private:
  int fd_;
};

tl::unexpected<Error> refuse_io(const std::filesystem::path& path) {
  const Code code = errno == ENOENT ? Code::kNotFound : Code::kIo;
  return refuse(code, path.string() + ": " + std::strerror(errno));
}

bool write_all(int fd, ByteSpan bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(fd, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return true;
}

std::filesystem::path beside_of(const std::filesystem::path& file) { return file.string() + ".part"; }

Result<void> write_beside(const FileToWrite& file) {
  const std::filesystem::path beside = beside_of(file.path);
  Descriptor out(beside, O_WRONLY | O_CREAT | O_TRUNC);
  if (out.get() < 0 || !write_all(out.get(), file.bytes) || ::fsync(out.get()) != 0 || !out.close()) {
    return refuse_io(beside);
  }
  return {};
}

/// Takes away what was written beside and not renamed.
class Beside {
 public:
  explicit Beside(std::span<const FileToWrite> files) : files_(files) {}
  Beside(const Beside&) = delete;
  Beside& operator=(const Beside&) = delete;
  ~Beside() {
    for (const FileToWrite& file : files_) ::unlink(beside_of(file.path).c_str());
  }

 private:
  std::span<const FileToWrite> files_;
};

Result<void> sync_folder_of(const std::filesystem::path& file) {
  const Descriptor folder(file.has_parent_path() ? file.parent_path() : ".", O_RDONLY | O_DIRECTORY);
  if (folder.get() < 0 || ::fsync(folder.get()) != 0) return refuse_io(file);
  return {};
}

}  // namespace

Result<Bytes> read_whole_file(const std::filesystem::path& file, std::uint64_t most) {
  const Descriptor in(file, O_RDONLY);
  struct stat status = {};
  if (in.get() < 0 || ::fstat(in.get(), &status) != 0) return refuse_io(file);
  if (!S_ISREG(status.st_mode)) return refuse(Code::kIo, file.string() + ": not a regular file");
  const auto size = static_cast<std::uint64_t>(status.st_size);
  if (size > most) return refuse(Code::kTooLarge, file.string() + ": over " + std::to_string(most) + " bytes");
  Bytes bytes(size);
  std::size_t have = 0;
  while (have < bytes.size()) {
    const ssize_t got = ::read(in.get(), bytes.data() + have, bytes.size() - have);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return refuse_io(file);
    if (got == 0) return refuse(Code::kIo, file.string() + ": became shorter while it was read");
    have += static_cast<std::size_t>(got);
  }
  return bytes;
}

Result<void> write_whole_file(const std::filesystem::path& file, ByteSpan bytes) {
  const FileToWrite one{file, bytes};
  return write_whole_files({&one, 1});
}

Result<void> write_whole_files(std::span<const FileToWrite> files) {
  const Beside beside(files);
  for (const FileToWrite& file : files) {
    if (const auto written = write_beside(file); !written) return written;
  }
  for (const FileToWrite& file : files) {
    if (::rename(beside_of(file.path).c_str(), file.path.c_str()) != 0) return refuse_io(file.path);
  }
  return sync_folder_of(files.front().path);
}

}  // namespace concord

#include "cli/file_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace concord {

Result<FileLock> FileLock::take(const std::filesystem::path& file, const std::string& held) {
  const std::filesystem::path folder = file.parent_path();
  std::error_code error;
  if (!folder.empty()) std::filesystem::create_directories(folder, error);
  if (error) return refuse(Code::kIo, "cannot make " + folder.string() + ": " + error.message());
  // Closed in the programs we start: they may outlive us by a moment.
  FileLock lock(open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644));
  if (lock.handle_ < 0) return refuse(Code::kIo, "cannot write in " + folder.string() + ": " + std::strerror(errno));
  if (flock(lock.handle_, LOCK_EX | LOCK_NB) == 0) return lock;
  if (errno == EWOULDBLOCK) return refuse(Code::kBusy, held);
  return refuse(Code::kIo, "cannot lock " + file.string() + ": " + std::strerror(errno));
}

FileLock::~FileLock() {
  if (handle_ >= 0) close(handle_);
}

}  // namespace concord

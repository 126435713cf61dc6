#include <unistd.h>

#include <fstream>

#include "bus/log_reader.hpp"
#include "must.hpp"

using namespace concord;

/// Any file: whole events, then an end or a refusal, never more bytes than there are.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::filesystem::path kFile = "/dev/shm/concord-fuzz-log-" + std::to_string(getpid());
  std::ofstream(kFile, std::ios::binary).write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  auto reader = LogReader::open(kFile);
  fuzz::must(reader.has_value());
  std::size_t taken = 0;
  while (true) {
    const auto event = reader->next();
    if (!event || !*event) break;
    taken += 28 + (*event)->channel.size() + (*event)->bytes.size();
    fuzz::must(taken <= size);
  }
  std::filesystem::remove(kFile);
  return 0;
}

#include <filesystem>
#include <fstream>

#include <stdlib.h>

#include "access/gate.hpp"
#include "must.hpp"
#include "server/static_files.hpp"

// Names in HTTP requests: one of the files that there are, or nothing.

using namespace concord;
using namespace concord::hmd;

namespace {

const StaticFiles& files() {
  static const StaticFiles kFiles = [] {
    std::string folder = "/dev/shm/concord-fuzz-web-XXXXXX";
    fuzz::must(mkdtemp(folder.data()) != nullptr);
    std::ofstream(folder + "/index.html") << "page";
    StaticFiles made;
    fuzz::must(made.add(folder, "/").has_value());
    std::filesystem::remove_all(folder);
    return made;
  }();
  return kFiles;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  const auto file = files().find(text);
  const std::string path = text.substr(0, text.find('?'));
  fuzz::must((file != nullptr) == (path == "/" || path == "/index.html"));
  (void)origin_allowed(text, "https", text, {text});
  if (is_local_host(text)) fuzz::must(text.find("evil") == std::string::npos);
  return 0;
}

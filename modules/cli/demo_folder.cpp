#include "cli/demo_folder.hpp"

#include <algorithm>
#include <fstream>

namespace concord {
namespace {

namespace fs = std::filesystem;

constexpr const char* kWritten[] = {"demo_state",   "demo_output", "demo.lcm",   "report.json",
                                    "overview.png", "map.bt",      "index.html", "site.yaml"};
/// Where this lies, a demo has been, and what is called as above is its own.
constexpr const char* kMarker = ".concord-demo";
constexpr const char* kMarkerText =
    "concord demo wrote demo_state, demo_output, demo.lcm, report.json, overview.png, map.bt, index.html and\n"
    "site.yaml in this folder. The next demo here replaces them.\n";

/// `file` is `folder`, or lies somewhere in it.
bool lies_in(const fs::path& file, const fs::path& folder) {
  return std::mismatch(folder.begin(), folder.end(), file.begin(), file.end()).first == folder.end();
}

tl::unexpected<Error> cannot(const std::string& what, const fs::path& path, const std::error_code& error) {
  return refuse(Code::kIo, "cannot " + what + " " + path.string() + ": " + error.message());
}

}  // namespace

Result<FileLock> DemoFolder::prepare(const std::vector<fs::path>& inputs) const {
  std::error_code error;
  const bool demo_was_here = fs::exists(path / kMarker, error);
  for (const char* name : kWritten) {
    const fs::path target = fs::weakly_canonical(path / name, error);
    for (const fs::path& input : inputs) {
      if (!lies_in(fs::weakly_canonical(input, error), target)) continue;
      return refuse(Code::kBadRequest, input.string() + " would be written over; give another folder with --out");
    }
    if (demo_was_here || !fs::exists(fs::symlink_status(path / name, error))) continue;
    return refuse(Code::kExists, (path / name).string() +
                                     " is not from a demo and would be written over; give another folder with --out");
  }
  auto lock = FileLock::take(
      path / kMarker, "a demo runs in " + path.string() + "; end that one first, or give another folder with --out");
  if (!lock) return lock;
  // Into the file that is locked: a new one in its place would not be.
  if (!(std::ofstream(path / kMarker) << kMarkerText << std::flush)) {
    return refuse(Code::kIo, "cannot write in " + path.string());
  }
  for (const char* name : kWritten) {
    fs::remove_all(path / name, error);
    if (error) return cannot("remove", path / name, error);
  }
  fs::create_directory(output(), error);
  if (error) return cannot("make", output(), error);
  return lock;
}

}  // namespace concord

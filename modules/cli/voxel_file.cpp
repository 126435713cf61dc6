#include "cli/voxel_file.hpp"

#include <fstream>
#include <optional>
#include <sstream>

#include "core/corrections.hpp"

namespace concord {
namespace {

/// One voxel: three whole numbers and nothing else. Absent where the line holds anything else.
std::optional<VoxelIndex> parse_voxel(const std::string& line) {
  std::istringstream in(line);
  VoxelIndex v;
  std::string more;
  if (!(in >> v.x >> v.y >> v.z) || in >> more) return std::nullopt;
  return v;
}

}  // namespace

Result<VoxelList> read_voxels(const std::string& file, double resolution) {
  std::ifstream in(file);
  if (!in) return refuse(Code::kNotFound, "cannot read " + file);
  std::vector<VoxelBox> single;
  std::int64_t number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    const auto voxel = parse_voxel(line);
    if (!voxel) {
      return refuse(Code::kMalformed, file + ", line " + std::to_string(number) +
                                          ": must hold one voxel, three whole numbers (map lattice)");
    }
    if (static_cast<std::int64_t>(single.size()) == kMaxEditVoxels) {
      return refuse(Code::kTooLarge, file + ", line " + std::to_string(number) + ": one edit holds at most " +
                                         std::to_string(kMaxEditVoxels) + " voxels; give it in parts");
    }
    single.push_back({*voxel, *voxel});
  }
  if (in.bad()) return refuse(Code::kIo, "cannot read " + file + " to its end");
  const auto voxels = expand(single, kMaxEditVoxels);
  if (!voxels) return tl::unexpected(voxels.error());
  auto list = voxel_list(*voxels, resolution);
  if (!list) return refuse(list.error().code, file + ": " + list.error().message);
  return list;
}

}  // namespace concord

#include "stock_octomap.hpp"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <sstream>
#include <unordered_map>

namespace concord::test {
namespace {

Bytes bytes_of(const std::ostringstream& stream) {
  const std::string text = stream.str();
  return {text.begin(), text.end()};
}

std::istringstream stream_of(const Bytes& bytes) { return std::istringstream(std::string(bytes.begin(), bytes.end())); }

}  // namespace

std::unique_ptr<octomap::OcTree> stock_read(const Bytes& file) {
  auto binary_tree = std::make_unique<octomap::OcTree>(0.1);
  auto stream = stream_of(file);
  const std::string title = "# Octomap OcTree binary";
  if (std::equal(title.begin(), title.end(), file.begin())) {
    return binary_tree->readBinary(stream) ? std::move(binary_tree) : nullptr;
  }
  return std::unique_ptr<octomap::OcTree>(dynamic_cast<octomap::OcTree*>(octomap::AbstractOcTree::read(stream)));
}

Bytes stock_data(const octomap::OcTree& tree, OctomapFormat format) {
  std::ostringstream stream;
  if (format == OctomapFormat::kBinary) {
    tree.writeBinaryData(stream);
  } else {
    tree.writeData(stream);
  }
  return bytes_of(stream);
}

Bytes stock_file(const octomap::OcTree& tree, OctomapFormat format) {
  octomap::OcTree copy(tree);
  std::ostringstream stream;
  if (format == OctomapFormat::kBinary) {
    copy.writeBinary(stream);
  } else {
    copy.write(stream);
  }
  return bytes_of(stream);
}

BrickMap expanded(const octomap::OcTree& tree, StockValues values) {
  DenseBrick unknown;
  unknown.fill(kUnknown);
  std::unordered_map<BrickIndex, DenseBrick, IndexHash> bricks;
  for (auto leaf = tree.begin_leafs(); leaf != tree.end_leafs(); ++leaf) {
    const int side = 1 << (tree.getTreeDepth() - leaf.getDepth());
    const octomap::OcTreeKey low = leaf.getIndexKey();
    const LogOdds state = tree.isNodeOccupied(*leaf) ? kOccupied : kFree;
    const LogOdds value = values == StockValues::kStates ? state : to_log_odds(leaf->getLogOdds());
    for (int z = 0; z < side; ++z) {
      for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) {
          const VoxelIndex v{low[0] + x - 32768, low[1] + y - 32768, low[2] + z - 32768};
          bricks.try_emplace(brick_of(v), unknown).first->second[local_of(v)] = value;
        }
      }
    }
  }
  BrickMap map;
  for (const auto& [index, dense] : bricks) map.set(index, Brick::from_dense(dense));
  return map;
}

octomap::OcTree scanned_tree(double resolution, unsigned seed) {
  octomap::OcTree tree(resolution);
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> around(-30.0f, 30.0f);
  for (int scan = 0; scan < 3; ++scan) {
    const auto reach = [&] { return static_cast<float>(resolution) * around(random); };
    octomap::Pointcloud cloud;
    for (int i = 0; i < 200; ++i) cloud.push_back(reach(), reach(), reach());
    tree.insertPointCloud(cloud, octomap::point3d(reach(), reach(), reach()));
  }
  return tree;
}

BrickMap states_of(const BrickMap& map) {
  BrickMap states;
  map.for_each_brick([&](BrickIndex index, const Brick& brick) {
    DenseBrick dense;
    brick.to_dense(dense);
    for (LogOdds& l : dense) {
      if (is_known(l)) l = is_occupied(l) ? kOccupied : kFree;
    }
    states.set(index, Brick::from_dense(dense));
  });
  return states;
}

std::vector<std::string> real_map_files() {
  const char* given = std::getenv("CONCORD_DATA");
  const std::filesystem::path data = given != nullptr ? given : CONCORD_SHARED_DATA;
  std::vector<std::string> files;
  for (const char* folder : {"slam_xr_maps", "octomap", "balm_building"}) {
    if (!std::filesystem::is_directory(data / folder)) continue;
    for (const auto& entry : std::filesystem::directory_iterator(data / folder)) {
      if (entry.path().extension() == ".bt") files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

Bytes file_bytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace concord::test

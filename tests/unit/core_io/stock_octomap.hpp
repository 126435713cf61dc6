#pragma once

#include <octomap/octomap.h>

#include <optional>
#include <string>
#include <vector>

#include "core/brick_map.hpp"
#include "core/byte_stream.hpp"
#include "core/octomap_format.hpp"

namespace concord::test {

/// What stock OctoMap makes of a file's bytes. @pre it can read them.
std::unique_ptr<octomap::OcTree> stock_read(const Bytes& file);

/// The payload that octomap_msgs would carry.
Bytes stock_data(const octomap::OcTree& tree, OctomapFormat format);
/// The file that stock OctoMap writes; a binary one from a copy that it has thresholded and pruned.
Bytes stock_file(const octomap::OcTree& tree, OctomapFormat format);

/// Every leaf of a tree expanded to single voxels, `value_of(leaf)` each.
enum class StockValues { kStates, kLogOdds };
BrickMap expanded(const octomap::OcTree& tree, StockValues values);

/// A tree that stock OctoMap has grown from a few scans.
octomap::OcTree scanned_tree(double resolution, unsigned seed);

/// The map with every value replaced by what a binary file keeps of it.
BrickMap states_of(const BrickMap& map);

/// Real maps among the shared test data; empty where they are absent.
std::vector<std::string> real_map_files();
Bytes file_bytes(const std::string& path);

}  // namespace concord::test

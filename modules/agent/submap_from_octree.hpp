#pragma once

#include <sstream>

#include "core/octomap_reader.hpp"

namespace concord {

/// The content of an octomap::OcTree as bricks at `resolution` (metres; the site's), states and log-odds kept (see
/// core/octomap_reader.hpp). A template, so that only robots that use OctoMap need it.
/// Refused: what the reader refuses (kTooLarge, kNotFinite, kBadResolution, ...).
template <class OcTree>
[[nodiscard]] Result<BrickMap> submap_from_octree(const OcTree& tree, double resolution) {
  std::ostringstream stream;
  tree.writeData(stream);
  const std::string bytes = stream.str();
  Result<OctomapImport> import =
      read_octomap_data(ByteSpan(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()),
                        OctomapFormat::kFull, tree.getResolution(), resolution);
  if (!import) return tl::unexpected(std::move(import.error()));
  return std::move(import->map);
}

}  // namespace concord

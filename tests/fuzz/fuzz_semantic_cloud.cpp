#include "must.hpp"
#include "semantic/labels/semantic_cloud.hpp"

using namespace concord;

/// A cloud that can be read is written as it was, but for the colours of a .ply, which say nothing.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const bool pcd = (data[0] & 1) != 0;
  Bytes file;
  if ((data[0] & 2) != 0) {  // behind a good header, with the number of points that fits
    const SemanticCloud empty{0.05, {{1, "chair"}}, std::vector<SemanticPoint>((size - 1) / (pcd ? 24 : 27))};
    file = pcd ? write_pcd(empty) : write_ply(empty);
    file.resize(file.size() - empty.points.size() * (pcd ? 24 : 27));
  }
  file.insert(file.end(), data + 1, data + size);
  const auto cloud = pcd ? read_pcd(file) : read_ply(file);
  if (!cloud) return 0;
  const auto again = pcd ? read_pcd(write_pcd(*cloud)) : read_ply(write_ply(*cloud));
  fuzz::must(again && *again == *cloud);
  (void)instances_of(*cloud);
  return 0;
}

#include "align/height_search.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "align/sampling.hpp"
#include "align/workers.hpp"

namespace concord {
namespace {

constexpr double kColumn = 0.5;  // metres
constexpr double kBin = 0.1;     // metres
constexpr float kLevelNormalZ = 0.9F;
constexpr std::size_t kMaxPieces = 4000;  // of the source
constexpr std::size_t kMinVotes = 50;
constexpr double kRivalShare = 0.6;
constexpr int kApart = 5;  // bins
constexpr std::size_t kMost = 2;

/// What is seen from above (floors, tables), from below (ceilings), or either; and everything.
struct Pieces {
  std::vector<Eigen::Vector3d> floors, ceilings, either, any;
};

Pieces pieces_of(const AlignMap& map, const Eigen::Matrix3d& R) {
  Pieces out;
  const SurfaceLevel& surface = map.levels[std::min<std::size_t>(1, map.levels.size() - 1)];
  StopLook stop;
  for (const SurfaceCell& cell : surface.cells()) {
    stop.step();
    const Eigen::Vector3d p = R * cell.mean.cast<double>();
    out.any.push_back(p);
    const double z = (R * cell.normal.cast<double>()).z();
    if (std::abs(z) < kLevelNormalZ) continue;
    (!cell.one_sided ? out.either : z > 0.0 ? out.floors : out.ceilings).push_back(p);
  }
  return out;
}

using Votes = std::map<int, double>;

void vote(const std::vector<Eigen::Vector3d>& target, const std::vector<Eigen::Vector3d>& source, const Transform& T,
          double low, double high, Votes& votes) {
  CellTable table;
  std::vector<std::vector<float>> heights;
  StopLook stop;
  for (const Eigen::Vector3d& p : target) {
    stop.step();
    VoxelIndex at = voxel_of(p, kColumn);
    at.z = 0;
    const auto column = static_cast<std::size_t>(table.insert(at));
    if (column == heights.size()) heights.emplace_back();
    heights[column].push_back(static_cast<float>(p.z()));
  }
  const std::size_t take = std::min(source.size(), kMaxPieces);
  for (std::size_t i = 0; i < take; ++i) {
    stop.step();
    const Eigen::Vector3d p = T * source[spread(i, take, source.size())];
    VoxelIndex at = voxel_of(p, kColumn);
    at.z = 0;
    const int column = table.find(at);
    if (column < 0) continue;
    for (const float z : heights[column]) {
      const double difference = z - p.z();
      if (difference >= low && difference <= high) ++votes[static_cast<int>(std::floor(difference / kBin))];
    }
  }
}

std::size_t count_of(const Votes& votes) {
  double sum = 0.0;
  for (const auto& [bin, count] : votes) sum += count;
  return static_cast<std::size_t>(sum);
}

/// A peak is looked for in three bins at once; its place is their mean.
std::vector<double> peaks_of(const Votes& votes) {
  struct Peak {
    double count, z;
    int bin;
  };
  const auto at = [&](int bin) {
    const auto found = votes.find(bin);
    return found == votes.end() ? 0.0 : found->second;
  };
  std::vector<Peak> peaks;
  for (const auto& [bin, count] : votes) {
    const double before = at(bin - 1);
    const double after = at(bin + 1);
    const double sum = before + count + after;
    peaks.push_back({sum, (bin + 0.5 + (after - before) / sum) * kBin, bin});
  }
  std::stable_sort(peaks.begin(), peaks.end(), [](const Peak& a, const Peak& b) { return a.count > b.count; });
  std::vector<double> out;
  std::vector<int> taken;
  for (const Peak& peak : peaks) {
    if (out.size() == kMost || peak.count < kRivalShare * peaks.front().count) break;
    if (std::any_of(taken.begin(), taken.end(), [&](int bin) { return std::abs(bin - peak.bin) < kApart; })) continue;
    out.push_back(peak.z);
    taken.push_back(peak.bin);
  }
  return out;
}

}  // namespace

std::vector<double> search_heights(const AlignMap& target, const Eigen::Matrix3d& R_upright_target,
                                   const AlignMap& source, const Eigen::Matrix3d& R_upright_source, const Transform& T,
                                   double low, double high) {
  const Pieces of_target = pieces_of(target, R_upright_target);
  const Pieces of_source = pieces_of(source, R_upright_source);
  Votes votes;
  vote(of_target.floors, of_source.floors, T, low, high, votes);
  vote(of_target.ceilings, of_source.ceilings, T, low, high, votes);
  if (count_of(votes) < kMinVotes) {
    vote(of_target.either, of_source.either, T, low, high, votes);
    vote(of_target.either, of_source.floors, T, low, high, votes);
    vote(of_target.floors, of_source.either, T, low, high, votes);
  }
  if (count_of(votes) < kMinVotes) vote(of_target.any, of_source.any, T, low, high, votes);
  return peaks_of(votes);
}

}  // namespace concord

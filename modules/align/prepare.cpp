#include "align/prepare.hpp"

#include <utility>

#include "align/cloud.hpp"
#include "align/workers.hpp"
#include "core/resample.hpp"

namespace concord {
namespace {

constexpr std::uint64_t kMaxBricks = 8'000'000;

bool wants_coarser(const Error& error) { return error.code == Code::kTooLarge || error.code == Code::kBadResolution; }

}  // namespace

Result<AlignMap> prepare_map(const BrickMap& map, double resolution, int threads) {
  auto out = make_align_map(map, resolution, threads);
  for (const double coarser : kAlignResolutions) {
    if (out || !wants_coarser(out.error())) break;
    if (coarser <= resolution) continue;
    const auto coarse = resample(map, resolution, coarser, kMaxBricks, stop_in_scope());
    look_for_stop();
    if (!coarse) return tl::unexpected(coarse.error());
    out = make_align_map(*coarse, coarser, threads);
  }
  return out;
}

Result<AlignMap> prepare_map(std::vector<Eigen::Vector3f> cloud, int threads) {
  PreparedCloud fine = prepare_cloud(std::move(cloud));
  auto out = make_align_map(fine.points, fine.resolution, threads);
  for (const double coarser : kAlignResolutions) {
    if (out || !wants_coarser(out.error())) break;
    if (coarser <= fine.resolution) continue;
    fine.points = thinned(std::move(fine.points), coarser);
    out = make_align_map(fine.points, coarser, threads);
  }
  return out;
}

}  // namespace concord

#include "cli/conflicts.hpp"

#include <memory>

#include "cli/extent.hpp"
#include "cli/numbers.hpp"
#include "cli/parts.hpp"
#include "cli/table.hpp"

namespace concord {
namespace {

std::string to_words(const ConflictRegion::Claim& claim) {
  return claim.agent + ": " + format_count(claim.occupied) + " occupied, " + format_count(claim.free) + " free";
}

Outcome conflicts(int most, const Common& common) {
  Live live(common);
  const ConflictRequest request{live.new_id(), most};
  const auto parts =
      ask_in_parts<ConflictList>(live, Desk{"in/conflict_request", "merge", "out/conflict_list"}, request);
  if (!parts) return tl::unexpected(parts.error());
  common.print(to_json(*parts, live.site().resolution), to_words(*parts, live.site().resolution));
  return Exit::kDone;
}

}  // namespace

nlohmann::json to_json(const std::vector<ConflictList>& parts, double resolution) {
  nlohmann::json regions = nlohmann::json::array();
  for (const ConflictList& part : parts) {
    for (const ConflictRegion& region : part.regions) {
      nlohmann::json claims = nlohmann::json::array();
      for (const auto& claim : region.claims) {
        claims.push_back({{"agent", claim.agent}, {"occupied", claim.occupied}, {"free", claim.free}});
      }
      regions.push_back({{"bounds", to_json(extent(region.min, region.max, resolution))},
                         {"voxels", region.voxels},
                         {"claims", claims}});
    }
  }
  return {{"voxels_in_all", parts.front().voxels_in_all},
          {"regions_in_all", parts.front().regions_in_all},
          {"regions", regions}};
}

std::string to_words(const std::vector<ConflictList>& parts, double resolution) {
  const ConflictList& first = parts.front();
  if (first.regions_in_all == 0) return "no conflicts";
  std::vector<std::vector<std::string>> rows = {{"voxels", kExtentHeading, "who claims what"}};
  std::int64_t shown = 0;
  for (const ConflictList& part : parts) {
    for (const ConflictRegion& region : part.regions) {
      std::string claims;
      for (const auto& claim : region.claims) claims += (claims.empty() ? "" : "; ") + to_words(claim);
      rows.push_back({format_count(region.voxels), to_words(extent(region.min, region.max, resolution)), claims});
      ++shown;
    }
  }
  std::string words = format_count(first.voxels_in_all) + " voxels in conflict, in " +
                      format_count(first.regions_in_all) + (first.regions_in_all == 1 ? " region" : " regions");
  if (shown < first.regions_in_all) words += "; the " + format_count(shown) + " with the most";
  return words + "\n" + format_table(rows, "rll");
}

void add_conflicts(Program& program) {
  auto most = std::make_shared<int>(20);
  program
      .add("conflicts", "where agents contradict each other, and who claims what",
           [most](const Common& common) { return conflicts(*most, common); })
      .add_option("--most", *most, "at most so many regions, those with the most voxels first")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
}

}  // namespace concord

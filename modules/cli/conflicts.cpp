#include "cli/conflicts.hpp"

#include <algorithm>
#include <memory>
#include <numeric>
#include <ranges>

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
  const ConflictRequest request{live.new_id(), kMostConflictRegions};
  const auto parts =
      ask_in_parts<ConflictList>(live, Respondent{"in/conflict_request", "merge", "out/conflict_list"}, request);
  if (!parts) return tl::unexpected(parts.error());
  if (const auto taken = live.take_resolution(); !taken) return tl::unexpected(taken.error());
  const Conflicts found = joined(*parts);
  const auto shown = static_cast<std::size_t>(most);
  const double resolution = live.site().resolution;
  common.print(to_json(found, shown, resolution), to_words(found, shown, resolution));
  return Exit::kDone;
}

bool same_agents(const ConflictRegion& a, const ConflictRegion& b) {
  return std::ranges::equal(a.claims, b.claims, {}, &ConflictRegion::Claim::agent, &ConflictRegion::Claim::agent);
}

/// Their boxes meet, be it over an edge or a corner: the voxels in them need not.
bool touch(const ConflictRegion& a, const ConflictRegion& b) {
  return a.min.x <= b.max.x + 1 && b.min.x <= a.max.x + 1 && a.min.y <= b.max.y + 1 && b.min.y <= a.max.y + 1 &&
         a.min.z <= b.max.z + 1 && b.min.z <= a.max.z + 1;
}

VoxelIndex lower(VoxelIndex a, VoxelIndex b) { return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)}; }
VoxelIndex upper(VoxelIndex a, VoxelIndex b) { return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)}; }

bool is_short(VoxelIndex min, VoxelIndex max) {
  return std::max({max.x - min.x, max.y - min.y, max.z - min.z}) < kLongestRegion;
}

/// @pre same_agents.
void add(const ConflictRegion& from, ConflictRegion& to) {
  to.min = lower(to.min, from.min);
  to.max = upper(to.max, from.max);
  to.voxels += from.voxels;
  for (std::size_t i = 0; i < to.claims.size(); ++i) {
    to.claims[i].occupied += from.claims[i].occupied;
    to.claims[i].free += from.claims[i].free;
  }
}

/// Regions by the first of those that they are joined with: touching is asked of the regions as they were listed.
std::vector<ConflictRegion> join(const std::vector<ConflictRegion>& listed) {
  std::vector<ConflictRegion> groups = listed;
  std::vector<std::size_t> group(listed.size());
  std::iota(group.begin(), group.end(), 0);
  for (std::size_t i = 0; i < listed.size(); ++i) {
    for (std::size_t j = i + 1; j < listed.size(); ++j) {
      const std::size_t a = std::min(group[i], group[j]), b = std::max(group[i], group[j]);
      if (a == b || !touch(listed[i], listed[j]) || !same_agents(groups[a], groups[b])) continue;
      if (!is_short(lower(groups[a].min, groups[b].min), upper(groups[a].max, groups[b].max))) continue;
      add(groups[b], groups[a]);
      std::ranges::replace(group, b, a);
    }
  }
  std::vector<ConflictRegion> joined;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    if (group[i] == i) joined.push_back(std::move(groups[i]));
  }
  return joined;
}

}  // namespace

Conflicts joined(const std::vector<ConflictList>& parts) {
  std::vector<ConflictRegion> listed;
  for (const ConflictList& part : parts) listed.insert(listed.end(), part.regions.begin(), part.regions.end());
  const bool all = static_cast<std::int64_t>(listed.size()) == parts.front().regions_in_all;
  Conflicts found{parts.front().voxels_in_all, join(listed), all};
  std::ranges::sort(found.regions, [](const ConflictRegion& a, const ConflictRegion& b) {
    return a.voxels != b.voxels ? a.voxels > b.voxels : a.min < b.min;
  });
  return found;
}

nlohmann::json to_json(const Conflicts& conflicts, std::size_t most, double resolution) {
  nlohmann::json regions = nlohmann::json::array();
  for (const ConflictRegion& region : conflicts.regions | std::views::take(most)) {
    nlohmann::json claims = nlohmann::json::array();
    for (const auto& claim : region.claims) {
      claims.push_back({{"agent", claim.agent}, {"occupied", claim.occupied}, {"free", claim.free}});
    }
    regions.push_back({{"bounds", to_json(extent(region.min, region.max, resolution))},
                       {"voxels", region.voxels},
                       {"claims", claims}});
  }
  return {{"voxels_in_all", conflicts.voxels},
          {"regions_in_all", conflicts.regions.size()},
          {"regions_are_all", conflicts.all},
          {"regions", regions}};
}

std::string to_words(const Conflicts& conflicts, std::size_t most, double resolution) {
  if (conflicts.regions.empty()) return "no conflicts";
  std::vector<std::vector<std::string>> rows = {{"voxels", kExtentHeading, "who claims what"}};
  for (const ConflictRegion& region : conflicts.regions | std::views::take(most)) {
    std::string claims;
    for (const auto& claim : region.claims) claims += (claims.empty() ? "" : "; ") + to_words(claim);
    rows.push_back({format_count(region.voxels), to_words(extent(region.min, region.max, resolution)), claims});
  }
  const auto regions = static_cast<std::int64_t>(conflicts.regions.size());
  const auto shown = static_cast<std::int64_t>(rows.size()) - 1;
  std::string words = format_count(conflicts.voxels) + " voxels in conflict, in " + (conflicts.all ? "" : "over ") +
                      format_count(regions) + (regions == 1 ? " region" : " regions");
  if (shown < regions || !conflicts.all) words += "; the " + format_count(shown) + " with the most";
  return words + "\n" + format_table(rows, "rll");
}

void add_conflicts(Program& program) {
  auto most = std::make_shared<int>(20);
  program
      .add("conflicts", "where agents contradict each other, and who claims what",
           [most](const Common& common) { return conflicts(*most, common); })
      .add_option("--most", *most, "at most so many regions, those with the most voxels first")
      ->check(CLI::Range(1, kMostConflictRegions))
      ->capture_default_str();
}

}  // namespace concord

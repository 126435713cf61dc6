#include "cli/archive_info.hpp"

#include <map>

#include "cli/extent.hpp"
#include "cli/history.hpp"
#include "cli/numbers.hpp"
#include "cli/table.hpp"

namespace concord {
namespace {

std::map<std::string, Zone> zones_of(const MapArchive& archive) {
  std::map<std::string, Zone> zones;
  for (const Correction& correction : archive.corrections) {
    const auto* change = std::get_if<Correction::ZoneChange>(&correction.what);
    if (change == nullptr) continue;
    if (change->op == ZoneRequest::Op::kDelete) {
      zones.erase(change->zone.name);
    } else {
      zones.insert_or_assign(change->zone.name, change->zone);
    }
  }
  return zones;
}

std::map<std::string, std::int64_t> count_kinds(const MapArchive& archive) {
  std::map<std::string, std::int64_t> counts;
  for (const Correction& correction : archive.corrections) ++counts[word_for(summary(correction, true).kind)];
  return counts;
}

}  // namespace

nlohmann::json to_json(const MapArchive& archive) {
  nlohmann::json layers = nlohmann::json::array(), zones = nlohmann::json::array();
  for (const auto& [head, bricks] : archive.layers) {
    layers.push_back({{"agent", head.agent},
                      {"kind", head.kind},
                      {"frame", head.frame_id},
                      {"weight", head.weight},
                      {"known", bricks.known_count()},
                      {"occupied", bricks.occupied_count()},
                      {"bricks", bricks.brick_count()}});
  }
  for (const auto& [title, zone] : zones_of(archive)) {
    zones.push_back({{"name", title}, {"kind", name(zone.kind)}, {"volume", to_json(zone.volume, zone.T_map_zone)}});
  }
  return {{"resolution", archive.resolution},
          {"layers", layers},
          {"corrections", count_kinds(archive)},
          {"revision", archive.corrections.empty() ? 0 : archive.corrections.back().revision},
          {"zones", zones}};
}

std::string to_words(const MapArchive& archive) {
  std::string words = "resolution  " + format_number(archive.resolution, 4) + " m\n";
  std::vector<std::vector<std::string>> layers = {{"layer", "kind", "frame", "weight", "known", "occupied"}};
  for (const auto& [head, bricks] : archive.layers) {
    layers.push_back({head.agent, head.kind, head.frame_id, std::to_string(head.weight),
                      format_count(static_cast<std::int64_t>(bricks.known_count())),
                      format_count(static_cast<std::int64_t>(bricks.occupied_count()))});
  }
  words += archive.layers.empty() ? "no layers\n" : format_table(layers, "lllrrr");
  words += format_count(static_cast<std::int64_t>(archive.corrections.size())) + " corrections";
  std::string separator = ": ";
  for (const auto& [kind, count] : count_kinds(archive)) {
    words += std::exchange(separator, ", ") + format_count(count) + " " + kind;
  }
  words += "\n";
  std::vector<std::vector<std::string>> zones = {{"zone", "kind", "shape", kExtentHeading}};
  for (const auto& [title, zone] : zones_of(archive)) {
    zones.push_back({title, name(zone.kind), kind_of(zone.volume), to_words(extent(zone.volume, zone.T_map_zone))});
  }
  return words + (zones.size() == 1 ? "no zones" : format_table(zones, "llll"));
}

}  // namespace concord

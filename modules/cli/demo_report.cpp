#include "cli/demo_report.hpp"

#include <algorithm>
#include <numeric>

#include <nlohmann/json.hpp>

#include "cli/map_file.hpp"
#include "cli/numbers.hpp"
#include "cli/report.hpp"

namespace concord {
namespace {

template <class T>
nlohmann::json or_null(const std::optional<T>& value) {
  return value ? nlohmann::json(*value) : nlohmann::json();
}

nlohmann::json path_or_null(const std::optional<Path>& path) { return path ? to_json(*path) : nlohmann::json(); }

std::optional<double> share_of(const std::optional<MapScore>& score, std::size_t feature) {
  if (!score || feature >= score->features.size()) return std::nullopt;
  return score->features[feature].share;
}

std::vector<Overview::Feature> features_of(const DemoReport& report) {
  std::vector<Overview::Feature> features;
  if (!report.merged) return features;
  for (std::size_t i = 0; i < report.merged->features.size(); ++i) {
    features.push_back({report.merged->features[i].name, share_of(report.robot, i), share_of(report.merged, i),
                        share_of(report.edited, i)});
  }
  return features;
}

nlohmann::json features_json(const DemoReport& report) {
  const std::vector<Overview::Feature> features = features_of(report);
  if (features.empty()) return nullptr;
  nlohmann::json object = nlohmann::json::object();
  for (const auto& f : features) {
    object[f.name] = {{"robot", or_null(f.robot)}, {"merged", or_null(f.merged)}, {"edited", or_null(f.edited)}};
  }
  return object;
}

const MapScore* last_score(const DemoReport& report) {
  if (report.edited) return &*report.edited;
  return report.merged ? &*report.merged : nullptr;
}

std::string percent(double share) { return format_number(100 * share, 1) + " %"; }

std::vector<std::pair<std::string, std::string>> numbers_of(const DemoReport& report) {
  std::vector<std::pair<std::string, std::string>> numbers;
  const auto add = [&](const char* name, std::string value) { numbers.push_back({name, std::move(value)}); };
  add("occupied voxels", format_count(static_cast<std::int64_t>(report.map->occupied_count())));
  if (const MapScore* score = last_score(report)) {
    add("precision (within one voxel)", percent(score->precision));
    add("true surface shown (recall)", percent(score->recall));
  }
  for (const auto& agent : report.agents) {
    if (agent.recall) numbers.push_back({"by " + agent.state.id + " alone", percent(*agent.recall)});
  }
  add("sent by agents", format_kilobytes(report.bytes_sent()));
  add("clouds lost on the way", format_count(report.clouds_lost()));
  return numbers;
}

std::string subtitle_of(const DemoReport& report) {
  std::string text = report.sources.empty()
                         ? "A robot, a cart with a depth camera and a headset map one warehouse together."
                         : "Maps of several sessions, merged as submaps.";
  if (!report.edit.empty()) text += " A person pinned what no sensor saw.";
  return text;
}

nlohmann::json driven_json(const DemoReport& report) {
  nlohmann::json points = nlohmann::json::array();
  for (const Eigen::Vector2d& p : report.driven) points.push_back({p.x(), p.y()});
  return points;
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '<': out += "&lt;"; break;
      case '>': out += "&gt;"; break;
      case '&': out += "&amp;"; break;
      default: out += c;
    }
  }
  return out;
}

std::string row(const std::vector<std::string>& cells, const char* tag) {
  std::string out = "<tr>";
  for (const std::string& cell : cells) out += std::string("<") + tag + ">" + escaped(cell) + "</" + tag + ">";
  return out + "</tr>\n";
}

std::string agents_table(const DemoReport& report) {
  std::string out =
      "<table>\n" +
      row({"agent", "kind", "known voxels", "occupied", "surface shown alone", "sent", "clouds lost"}, "th");
  for (const auto& agent : report.agents) {
    out += row({agent.state.id, agent.state.kind, format_count(agent.state.known), format_count(agent.state.occupied),
                agent.recall ? percent(*agent.recall) : "–", format_kilobytes(agent.bytes_sent),
                format_count(agent.clouds_lost)},
               "td");
  }
  return out + "</table>\n";
}

std::string features_table(const DemoReport& report) {
  const auto cell = [](const std::optional<double>& share) { return share ? percent(*share) : std::string("–"); };
  const std::vector<Overview::Feature> features = features_of(report);
  if (features.empty()) return "";
  std::string out = "<table>\n" + row({"found of", "by the robot", "after merging", "after the edit"}, "th");
  for (const auto& f : features) out += row({f.name, cell(f.robot), cell(f.merged), cell(f.edited)}, "td");
  return out + "</table>\n";
}

std::string paths_table(const DemoReport& report) {
  if (!report.path_before && !report.path_after) return "";
  std::string out = "<table>\n" + row({"path", "", ""}, "th");
  for (const auto& [name, path] :
       {std::pair{"before the edit", &report.path_before}, {"after the edit", &report.path_after}}) {
    if (!*path) continue;
    const bool found = (*path)->status == "OK";
    out += row({name, (*path)->status, found ? format_number((*path)->length, 1) + " m" : (*path)->message}, "td");
  }
  return out + "</table>\n";
}

}  // namespace

std::int64_t DemoReport::bytes_sent() const {
  return std::accumulate(agents.begin(), agents.end(), std::int64_t{0},
                         [](std::int64_t sum, const Agent& agent) { return sum + agent.bytes_sent; });
}

std::int64_t DemoReport::clouds_lost() const {
  return std::accumulate(agents.begin(), agents.end(), std::int64_t{0},
                         [](std::int64_t sum, const Agent& agent) { return sum + agent.clouds_lost; });
}

nlohmann::json to_json(const DemoReport& report) {
  nlohmann::json agents = nlohmann::json::array();
  for (const auto& agent : report.agents) {
    nlohmann::json object = to_json(agent.state);
    object["voxels"] = agent.state.known;
    object["bytes_sent"] = agent.bytes_sent;
    object["clouds_lost"] = agent.clouds_lost;
    object["recall"] = or_null(agent.recall);
    agents.push_back(std::move(object));
  }
  const MapScore* score = last_score(report);
  const std::size_t known = report.map->known_count(), occupied = report.map->occupied_count();
  return {{"complete", report.complete()},
          {"resolution", report.resolution},
          {"sources", report.sources},
          {"agents", agents},
          {"map",
           {{"known", known},
            {"occupied", occupied},
            {"free", known - occupied},
            {"conflicting", report.conflicts->known_count()},
            {"digest", hex(digest(*report.map))},
            {"precision", score != nullptr ? nlohmann::json(score->precision) : nlohmann::json()},
            {"recall", score != nullptr ? nlohmann::json(score->recall) : nlohmann::json()}}},
          {"features", features_json(report)},
          {"edit", report.edit.empty() ? nlohmann::json()
                                       : nlohmann::json{{"voxels", report.edit.size()}, {"author", report.author}}},
          {"path_before", path_or_null(report.path_before)},
          {"path_after", path_or_null(report.path_after)},
          {"replanned", or_null(report.replanned)},
          {"arrived", or_null(report.arrived)},
          {"driven", driven_json(report)},
          {"mapping_seconds",
           {{"one_agent", or_null(report.one_agent_seconds)}, {"all_agents", or_null(report.all_agents_seconds)}}},
          {"bytes_sent", report.bytes_sent()},
          {"seconds", report.seconds}};
}

Overview to_overview(const DemoReport& report) {
  Overview overview;
  overview.title = "Concord";
  overview.subtitle = subtitle_of(report);
  overview.resolution = report.resolution;
  overview.cut = report.cut;
  overview.map = report.map;
  overview.conflicts = report.conflicts;
  for (const auto& agent : report.agents) {
    overview.agents.push_back({agent.state.id, agent.map, agent.state.T_map_agent, agent.state.known});
  }
  overview.edit = report.edit;
  if (report.path_before) overview.before = to_route(*report.path_before);
  if (report.path_after) overview.after = to_route(*report.path_after);
  overview.start = report.start;
  overview.goal = report.goal;
  overview.driven = report.driven;
  overview.features = features_of(report);
  overview.numbers = numbers_of(report);
  return overview;
}

std::string to_html(const DemoReport& report) {
  std::string out = R"(<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>Concord: the demo's map</title>
<style>
body { margin: 2rem auto; max-width: 1300px; padding: 0 1rem; background: #f1eee8; color: #212429;
       font: 15px/1.5 "DejaVu Sans", system-ui, sans-serif; }
img { width: 100%; height: auto; }
table { border-collapse: collapse; margin: 1.5rem 0; }
th, td { text-align: left; padding: .3rem 1.6rem .3rem 0; border-bottom: 1px solid #cfcac0; }
th { color: #6b6b70; font-weight: 600; }
td + td { font-variant-numeric: tabular-nums; }
</style></head><body>
<a href="overview.png"><img src="overview.png" alt="The map from above"></a>
)";
  out += agents_table(report) + features_table(report) + paths_table(report);
  out +=
      "<p>The map: <a href=\"map.bt\">map.bt</a> (OctoMap). All numbers: <a href=\"report.json\">report.json</a>. "
      "What lcm-logger heard of all that was said: <a href=\"demo.lcm\">demo.lcm</a>; it cannot ask again for what it "
      "missed, and <code>./run replay</code> names that.</p>\n</body></html>\n";
  return out;
}

Result<void> write_report(const DemoReport& report, const std::filesystem::path& folder) {
  const std::string json = to_json(report).dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
  if (auto written = write_file(folder / "report.json", json); !written) return written;
  if (auto drawn = write_overview(to_overview(report), folder / "overview.png"); !drawn) {
    return tl::unexpected(drawn.error());
  }
  return write_file(folder / "index.html", to_html(report));
}

}  // namespace concord

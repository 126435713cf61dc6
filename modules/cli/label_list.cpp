#include "cli/label_list.hpp"

#include <algorithm>
#include <array>

#include "bus/messages_label.hpp"
#include "cli/extent.hpp"
#include "cli/numbers.hpp"
#include "cli/parts.hpp"
#include "cli/report.hpp"
#include "cli/table.hpp"

namespace concord {

tl::expected<std::vector<LabelInstance>, Failure> request_labels(Live& live, LabelQuery query) {
  query.id = live.new_id();
  const auto parts = ask_in_parts<LabelList>(live, Respondent{"in/label_query", "semantic", "out/label_list"}, query);
  if (!parts) return tl::unexpected(parts.error());
  std::vector<LabelInstance> all;
  for (const LabelList& part : *parts) all.insert(all.end(), part.instances.begin(), part.instances.end());
  return all;
}

tl::expected<ClassId, Failure> class_called(Live& live, const std::string& name) {
  LabelQuery query;
  query.kind = LabelQuery::Kind::kClasses;
  const auto all = request_labels(live, query);
  if (!all) return tl::unexpected(all.error());
  const auto found = std::ranges::find(*all, name, &LabelInstance::name);
  if (found == all->end()) {
    return fail(Exit::kRefused, "NOT_FOUND", "no class " + name + "; see: concord labels --classes");
  }
  return found->of.label;
}

nlohmann::json to_json(const LabelInstance& instance, double resolution) {
  const Eigen::Vector3d& c = instance.centroid;
  nlohmann::json out = {{"class", instance.name},
                        {"label", instance.of.label},
                        {"instance", instance.of.instance},
                        {"voxels", instance.voxels},
                        {"centroid", std::array<double, 3>{c.x(), c.y(), c.z()}},
                        {"box", nullptr}};
  if (!instance.asset.empty()) {
    out["asset"] = instance.asset;
    out["T_map_asset"] = to_numbers(instance.T_map_asset);
  }
  if (instance.voxels > 0) out["box"] = to_json(extent(instance.min, instance.max, resolution));
  return out;
}

std::string to_words(const std::vector<LabelInstance>& instances, double resolution) {
  std::vector<std::vector<std::string>> rows;
  for (const LabelInstance& one : instances) {
    const bool is_class = one.of.instance == 0;
    rows.push_back({one.name, is_class ? "class " + std::to_string(one.of.label) : std::to_string(one.of.instance),
                    is_class ? "" : format_count(one.voxels) + " voxels",
                    one.voxels > 0 ? to_words(extent(one.min, one.max, resolution)) : "",
                    one.asset.empty() ? "" : "asset " + one.asset});
  }
  return format_table(rows, "lrrll");
}

}  // namespace concord

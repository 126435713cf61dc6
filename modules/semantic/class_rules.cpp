#include "semantic/class_rules.hpp"

#include <yaml-cpp/yaml.h>

#include "core/label_corrections.hpp"
#include "core/text.hpp"

namespace concord {
namespace {

constexpr double kMostMargin = 10.0;

tl::unexpected<Error> bad(Code code, const std::string& what) { return refuse(code, "classes.yaml: " + what); }

Result<ClassRule> rule_of(const std::string& name, const YAML::Node& node) {
  if (!is_title(name)) return bad(Code::kBadName, "'" + name + "' is no name of a class");
  ClassRule rule;
  for (const auto& entry : node) {
    const auto key = entry.first.as<std::string>();
    if (key != "margin") return bad(Code::kMalformed, name + " has an unknown key " + key);
    rule.margin = entry.second.as<double>();
  }
  if (!(rule.margin >= 0.0 && rule.margin <= kMostMargin)) {
    return bad(Code::kMalformed, name + " has a margin that is not between 0 and 10 m");
  }
  return rule;
}

}  // namespace

Result<std::map<std::string, ClassRule>> read_class_rules(const std::filesystem::path& file) {
  std::map<std::string, ClassRule> out;
  std::error_code error;
  if (!std::filesystem::exists(file, error)) return out;
  try {
    const YAML::Node all = YAML::LoadFile(file.string());
    if (all.IsNull()) return out;
    if (!all.IsMap()) return bad(Code::kMalformed, "must be a map of names");
    if (all.size() > kMaxClasses) return bad(Code::kTooLarge, "has over " + std::to_string(kMaxClasses) + " classes");
    for (const auto& entry : all) {
      const auto name = entry.first.as<std::string>();
      const auto rule = rule_of(name, entry.second);
      if (!rule) return tl::unexpected(rule.error());
      out[name] = *rule;
    }
  } catch (const YAML::Exception& e) {
    return bad(Code::kMalformed, e.what());
  }
  return out;
}

}  // namespace concord

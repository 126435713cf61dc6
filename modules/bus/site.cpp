#include "bus/site.hpp"

#include <cmath>
#include <fstream>
#include <limits>
#include <regex>
#include <set>
#include <sstream>

#include <yaml-cpp/yaml.h>

#include "bus/lcm_url.hpp"
#include "core/corrections.hpp"
#include "core/label_corrections.hpp"
#include "core/requests.hpp"
#include "core/text.hpp"

namespace concord {
namespace {

constexpr std::size_t kMaxSiteFile = 1 << 20;

[[noreturn]] void fail(const YAML::Node& node, const std::string& what) {
  throw ConfigError("line " + std::to_string(node.Mark().line + 1) + ": " + what);
}

/// The keys of a map; one that stands there twice is an error, or its second value would be lost without a word.
std::set<std::string> keys_once(const YAML::Node& node, const std::string& name) {
  std::set<std::string> keys;
  for (const auto& entry : node) {
    const auto key = entry.first.as<std::string>();
    if (!keys.insert(key).second) fail(entry.first, name + "." + key + " is given twice");
  }
  return keys;
}

/// One section of the file: reads the keys it knows and refuses the rest when it goes out of scope by `done`.
class Section {
 public:
  Section(const YAML::Node& node, std::string name) : node_(node), name_(std::move(name)) {
    if (node_ && !node_.IsNull() && !node_.IsMap()) fail(node_, name_ + " must hold keys and values");
  }

  template <class T>
  void read(const char* key, T& value) {
    const YAML::Node node = take(key);
    if (!node) return;
    if (node.IsNull()) fail(key_node(key), name_ + "." + key + " has no value");  // a string would become "null"
    try {
      value = node.as<T>();
    } catch (const YAML::Exception&) {
      fail(node, name_ + "." + key + " has the wrong type");
    }
  }
  template <class Number>
  void read(const char* key, Number& value, Number low, Number high) {
    read(key, value);
    if (value >= low && value <= high) return;
    std::ostringstream what;
    what << name_ << "." << key << " must lie between " << low << " and " << high;
    fail(take(key), what.str());
  }
  /// A value that `ok` accepts.
  template <class T, class Ok>
  void read(const char* key, T& value, Ok ok, const std::string& must) {
    read(key, value);
    if (!ok(value)) fail(take(key), name_ + "." + key + " must be " + must);
  }
  [[nodiscard]] YAML::Node take(const char* key) {
    known_.insert(key);
    return node_ && node_.IsMap() ? node_[key] : YAML::Node(YAML::NodeType::Undefined);
  }
  void done() const {
    if (!node_ || !node_.IsMap()) return;
    for (const std::string& key : keys_once(node_, name_)) {
      if (!known_.contains(key)) fail(key_node(key), "unknown key " + name_ + "." + key);
    }
  }

 private:
  [[nodiscard]] YAML::Node key_node(const std::string& key) const {
    for (const auto& entry : node_) {
      if (entry.first.as<std::string>() == key) return entry.first;
    }
    return node_;
  }

  YAML::Node node_;
  std::string name_;
  std::set<std::string> known_;
};

/// Both heights or none.
void read_band(Section& section, const std::string& name, AgentConfig& agent) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  double zmin = agent.band ? agent.band->first : kNone;
  double zmax = agent.band ? agent.band->second : kNone;
  section.read("zmin", zmin);
  section.read("zmax", zmax);
  if (std::isnan(zmin) && std::isnan(zmax)) return;
  if (!(zmin < zmax && zmin >= -1000 && zmax <= 1000)) {
    throw ConfigError(name + " needs both zmin and zmax, from -1000 to 1000 m, zmin below zmax");
  }
  agent.band = {zmin, zmax};
}

AgentConfig read_agent(const YAML::Node& node, const std::string& name, AgentConfig agent) {
  Section section(node, name);
  section.read(
      "kind", agent.kind, [](const std::string& kind) { return is_name(kind); }, "1 to 40 of A-Z a-z 0-9 . _ -");
  section.read("weight", agent.weight, 1, 1000);
  section.read("radius", agent.radius, 0.0, 10.0);
  section.read("speed", agent.speed, 0.01, 100.0);
  section.read("footprint", agent.footprint);
  section.read("turn_radius", agent.turn_radius, 0.0, 100.0);
  read_band(section, name, agent);
  section.done();
  return agent;
}

void read_agents(const YAML::Node& node, Site& site) {
  if (!node || node.IsNull()) return;
  if (!node.IsMap()) fail(node, "agents must hold one entry per agent id");
  (void)keys_once(node, "agents");
  if (node["unlisted"]) site.unlisted = read_agent(node["unlisted"], "agents.unlisted", site.unlisted);
  for (const auto& entry : node) {
    const auto id = entry.first.as<std::string>();
    if (id == "unlisted") continue;
    if (!is_name(id)) fail(entry.first, "agent id " + id + " must be 1 to 40 of A-Z a-z 0-9 . _ -");
    site.agents[id] = read_agent(entry.second, "agents." + id, site.unlisted);
  }
}

ClassTerms read_class(const YAML::Node& node, const std::string& name) {
  Section section(node, name);
  ClassTerms terms;
  section.read("margin", terms.margin, 0.0, Zone::kMaxMargin);
  section.read("cost", terms.cost, 0, Zone::kMaxCost);
  section.read("cost_margin", terms.cost_margin, 0.0, Zone::kMaxMargin);
  section.done();
  if (terms.cost == 0 && terms.cost_margin == 0.0) return terms;
  if (terms.cost == 0 || terms.cost_margin <= terms.margin) {
    fail(node, name + " needs both cost and cost_margin, the latter above margin");
  }
  return terms;
}

void read_classes(const YAML::Node& node, Site& site) {
  if (!node || node.IsNull()) return;
  if (!node.IsMap()) fail(node, "classes must hold one entry per class of labels");
  if (node.size() > kMaxClasses) fail(node, "classes are over " + std::to_string(kMaxClasses));
  (void)keys_once(node, "classes");
  for (const auto& entry : node) {
    const auto name = entry.first.as<std::string>();
    if (!is_title(name)) fail(entry.first, "'" + name + "' is no name of a class");
    site.classes[name] = read_class(entry.second, "classes." + name);
  }
}

Policy read_policy(Section& section, Policy policy) {
  std::string name = policy == Policy::kMean ? "mean" : "table";
  section.read(
      "policy", name, [](const std::string& p) { return p == "mean" || p == "table"; }, "mean or table");
  return name == "mean" ? Policy::kMean : Policy::kTable;
}

std::filesystem::path read_path(Section& section, const char* key, const std::filesystem::path& directory) {
  std::string path;
  section.read(key, path);
  return path.empty() ? std::filesystem::path() : directory / path;
}

void read_bridge(const YAML::Node& node, const std::filesystem::path& directory, Site::Bridge& bridge) {
  Section section(node, "bridge");
  section.read("listen", bridge.listen);
  section.read("port", bridge.port, std::int64_t{0}, std::int64_t{65535});
  section.read("tls", bridge.tls);
  bridge.certificate = read_path(section, "certificate", directory);
  bridge.key = read_path(section, "key", directory);
  section.read("origins", bridge.origins);
  section.read(
      "local_role", bridge.local_role, [](const std::string& r) { return r == "view" || r == "edit" || r == "robot"; },
      "view, edit or robot");
  section.read("max_clients", bridge.max_clients, std::int64_t{1}, std::int64_t{1000});
  section.done();
  const bool local = bridge.listen == "127.0.0.1" || bridge.listen == "::1" || bridge.listen == "localhost";
  if (local || bridge.tls) return;
  throw ConfigError("bridge.listen " + bridge.listen +
                    " is reached from other machines: set bridge.tls: true and run concord cert");
}

/// Whether packets stay on this host. LCM takes the time-to-live from the url, and more than 0 where it has none.
bool stays_on_host(const std::string& url) {
  if (url.rfind("memq:", 0) == 0 || url.rfind("file:", 0) == 0) return true;
  static const std::regex kTtlZero(R"((udpm|mpudpm)://[^?]*\?([^&]+&)*ttl=0(&.*)?)");
  const std::size_t ttl = url.find("ttl");
  return std::regex_match(url, kTtlZero) && url.find("ttl", ttl + 1) == std::string::npos;
}

void check_reach(const Site& site) {
  if (site.beyond_host || stays_on_host(site.lcm_url)) return;
  throw ConfigError(
      "lcm_url has a ttl above 0 or none: LCM has no authentication; "
      "use ttl=0, or set beyond_host: true on a trusted network");
}

Site read_site(const YAML::Node& root, const std::filesystem::path& directory) {
  Site site;
  Section top(root, "site");
  top.read("lcm_url", site.lcm_url);
  if (const auto usable = check_lcm_url(site.lcm_url); !usable) fail(top.take("lcm_url"), usable.error().message);
  top.read("beyond_host", site.beyond_host);
  std::string state = site.state;
  top.read(
      "state", state, [](const std::string& folder) { return !folder.empty(); },
      "a folder; relative ones lie beside this file");
  site.state = directory / state;  // an absolute path stays as it is
  top.read("resolution", site.resolution, 0.005, 1.0);
  read_agents(top.take("agents"), site);
  read_classes(top.take("classes"), site);

  Section stream(top.take("stream"), "stream");
  stream.read("bytes_per_second", site.stream.bytes_per_second, 1e4, 1e9);
  stream.done();

  Section ingest(top.take("ingest"), "ingest");
  ingest.read("max_agents", site.ingest.max_agents, std::int64_t{1}, std::int64_t{1000});
  ingest.read("max_known_voxels", site.ingest.max_known_voxels, std::int64_t{1}, std::int64_t{4'000'000'000});
  ingest.done();

  Section merge(top.take("merge"), "merge");
  site.merge.policy = read_policy(merge, site.merge.policy);
  merge.done();

  Section planner(top.take("planner"), "planner");
  planner.read("zmin", site.planner.zmin, -1000.0, 1000.0);
  planner.read("zmax", site.planner.zmax, -1000.0, 1000.0);
  planner.read(
      "free_share", site.planner.free_share, [](double share) { return share > 0 && share <= 1; },
      "above 0, at most 1");
  planner.done();
  read_bridge(top.take("bridge"), directory, site.bridge);
  if (site.planner.zmin >= site.planner.zmax) throw ConfigError("planner.zmin must be below planner.zmax");

  top.done();
  check_reach(site);
  return site;
}

}  // namespace

Site parse_site(const std::string& yaml, const std::filesystem::path& directory) {
  if (yaml.size() > kMaxSiteFile) throw ConfigError("is larger than any site file");
  try {
    return read_site(YAML::Load(yaml), directory);
  } catch (const YAML::Exception& e) {
    throw ConfigError(e.what());
  }
}

Site load_site(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::string yaml(kMaxSiteFile + 1, ' ');
  in.read(yaml.data(), static_cast<std::streamsize>(yaml.size()));
  yaml.resize(static_cast<std::size_t>(in.gcount()));
  if (in.bad() || (!in.eof() && yaml.size() <= kMaxSiteFile)) throw ConfigError(file.string() + ": cannot be read");
  try {
    return parse_site(yaml, std::filesystem::absolute(file).parent_path());
  } catch (const ConfigError& e) {
    throw ConfigError(file.string() + ": " + e.what());
  }
}

}  // namespace concord

#include "bus/site.hpp"

#include <cmath>
#include <set>

#include <yaml-cpp/yaml.h>

#include "core/requests.hpp"

namespace concord {
namespace {

[[noreturn]] void fail(const YAML::Node& node, const std::string& what) {
  throw ConfigError("line " + std::to_string(node.Mark().line + 1) + ": " + what);
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
    try {
      value = node.as<T>();
    } catch (const YAML::Exception&) {
      fail(node, name_ + "." + key + " has the wrong type");
    }
  }
  void read_number(const char* key, double& value, double low, double high) {
    read(key, value);
    if (!(value >= low && value <= high)) out_of_range(key, low, high);
  }
  void read_integer(const char* key, std::int64_t& value, std::int64_t low, std::int64_t high) {
    read(key, value);
    if (value < low || value > high) out_of_range(key, static_cast<double>(low), static_cast<double>(high));
  }
  [[nodiscard]] YAML::Node take(const char* key) {
    known_.insert(key);
    return node_ && node_.IsMap() ? node_[key] : YAML::Node(YAML::NodeType::Undefined);
  }
  void done() const {
    if (!node_ || !node_.IsMap()) return;
    for (const auto& entry : node_) {
      const auto key = entry.first.as<std::string>();
      if (!known_.contains(key)) fail(entry.first, "unknown key " + name_ + "." + key);
    }
  }

 private:
  [[noreturn]] void out_of_range(const char* key, double low, double high) const {
    throw ConfigError(name_ + "." + key + " must lie between " + std::to_string(low) + " and " + std::to_string(high));
  }

  YAML::Node node_;
  std::string name_;
  std::set<std::string> known_;
};

AgentConfig read_agent(const YAML::Node& node, const std::string& name, AgentConfig agent) {
  Section section(node, name);
  section.read("kind", agent.kind);
  std::int64_t weight = agent.weight;
  section.read_integer("weight", weight, 1, 1000);
  agent.weight = static_cast<int>(weight);
  section.read_number("radius", agent.radius, 0.0, 10.0);
  section.done();
  if (!is_name(agent.kind)) throw ConfigError(name + ".kind must be 1 to 40 of A-Z a-z 0-9 . _ -");
  return agent;
}

void read_agents(const YAML::Node& node, Site& site) {
  if (!node || node.IsNull()) return;
  if (!node.IsMap()) fail(node, "agents must hold one entry per agent id");
  if (node["unlisted"]) site.unlisted = read_agent(node["unlisted"], "agents.unlisted", site.unlisted);
  for (const auto& entry : node) {
    const auto id = entry.first.as<std::string>();
    if (id == "unlisted") continue;
    if (!is_name(id)) fail(entry.first, "agent id " + id + " must be 1 to 40 of A-Z a-z 0-9 . _ -");
    site.agents[id] = read_agent(entry.second, "agents." + id, site.unlisted);
  }
}

Policy read_policy(Section& section, Policy policy) {
  std::string name = policy == Policy::kMean ? "mean" : "table";
  section.read("policy", name);
  if (name == "mean") return Policy::kMean;
  if (name == "table") return Policy::kTable;
  throw ConfigError("merge.policy must be mean or table");
}

/// LCM takes the time-to-live from the url; above 0 packets leave the host.
void check_reach(const Site& site) {
  const auto at = site.lcm_url.find("ttl=");
  const bool stays =
      site.lcm_url.rfind("udpm", 0) != 0 || (at != std::string::npos && std::atoi(site.lcm_url.c_str() + at + 4) == 0);
  if (!stays && !site.beyond_host) {
    throw ConfigError(
        "lcm_url has a ttl above 0 or none: LCM has no authentication; "
        "use ttl=0, or set beyond_host: true on a trusted network");
  }
}

Site read_site(const YAML::Node& root, const std::filesystem::path& directory) {
  Site site;
  Section top(root, "site");
  top.read("lcm_url", site.lcm_url);
  top.read("beyond_host", site.beyond_host);
  std::string state = site.state;
  top.read("state", state);
  site.state = directory / state;  // an absolute path stays as it is
  top.read_number("resolution", site.resolution, 0.005, 1.0);
  read_agents(top.take("agents"), site);

  Section stream(top.take("stream"), "stream");
  stream.read_number("bytes_per_second", site.stream.bytes_per_second, 1e4, 1e9);
  stream.done();

  Section ingest(top.take("ingest"), "ingest");
  ingest.read_integer("max_agents", site.ingest.max_agents, 1, 1000);
  ingest.read_integer("max_known_voxels", site.ingest.max_known_voxels, 1, 4'000'000'000);
  ingest.done();

  Section merge(top.take("merge"), "merge");
  site.merge.policy = read_policy(merge, site.merge.policy);
  merge.done();

  Section planner(top.take("planner"), "planner");
  planner.read_number("zmin", site.planner.zmin, -1000, 1000);
  planner.read_number("zmax", site.planner.zmax, -1000, 1000);
  planner.read_number("free_share", site.planner.free_share, 0.0, 1.0);
  planner.done();
  if (site.planner.zmin >= site.planner.zmax) throw ConfigError("planner.zmin must be below planner.zmax");

  top.done();
  check_reach(site);
  return site;
}

}  // namespace

Site load_site(const std::filesystem::path& file) {
  try {
    return read_site(YAML::LoadFile(file), std::filesystem::absolute(file).parent_path());
  } catch (const YAML::BadFile&) {
    throw ConfigError(file.string() + ": cannot be read");
  } catch (const YAML::Exception& e) {
    throw ConfigError(file.string() + ": " + e.what());
  } catch (const ConfigError& e) {
    throw ConfigError(file.string() + ": " + e.what());
  }
}

std::string to_yaml(const Site& site) {
  YAML::Node root;
  root["lcm_url"] = site.lcm_url;
  root["beyond_host"] = site.beyond_host;
  root["state"] = site.state.string();
  root["resolution"] = site.resolution;
  const auto put_agent = [&](const std::string& id, const AgentConfig& agent) {
    root["agents"][id]["kind"] = agent.kind;
    root["agents"][id]["weight"] = agent.weight;
    root["agents"][id]["radius"] = agent.radius;
  };
  put_agent("unlisted", site.unlisted);
  for (const auto& [id, agent] : site.agents) put_agent(id, agent);
  root["stream"]["bytes_per_second"] = site.stream.bytes_per_second;
  root["ingest"]["max_agents"] = site.ingest.max_agents;
  root["ingest"]["max_known_voxels"] = site.ingest.max_known_voxels;
  root["merge"]["policy"] = site.merge.policy == Policy::kMean ? "mean" : "table";
  root["planner"]["zmin"] = site.planner.zmin;
  root["planner"]["zmax"] = site.planner.zmax;
  root["planner"]["free_share"] = site.planner.free_share;
  YAML::Emitter out;
  out << root;
  return out.c_str();
}

}  // namespace concord

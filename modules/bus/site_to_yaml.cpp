#include <yaml-cpp/yaml.h>

#include "bus/site.hpp"

namespace concord {

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
    root["agents"][id]["speed"] = agent.speed;
    if (!agent.footprint.empty()) {
      root["agents"][id]["footprint"] = agent.footprint;
      root["agents"][id]["turn_radius"] = agent.turn_radius;
    }
    if (!agent.band) return;
    root["agents"][id]["zmin"] = agent.band->first;
    root["agents"][id]["zmax"] = agent.band->second;
  };
  put_agent("unlisted", site.unlisted);
  for (const auto& [id, agent] : site.agents) put_agent(id, agent);
  for (const auto& [name, terms] : site.classes) {
    root["classes"][name]["margin"] = terms.margin;
    root["classes"][name]["cost"] = terms.cost;
    root["classes"][name]["cost_margin"] = terms.cost_margin;
  }
  root["stream"]["bytes_per_second"] = site.stream.bytes_per_second;
  root["ingest"]["max_agents"] = site.ingest.max_agents;
  root["ingest"]["max_known_voxels"] = site.ingest.max_known_voxels;
  root["merge"]["policy"] = site.merge.policy == Policy::kMean ? "mean" : "table";
  root["planner"]["zmin"] = site.planner.zmin;
  root["planner"]["zmax"] = site.planner.zmax;
  root["planner"]["free_share"] = site.planner.free_share;
  root["bridge"]["listen"] = site.bridge.listen;
  root["bridge"]["port"] = site.bridge.port;
  root["bridge"]["tls"] = site.bridge.tls;
  if (!site.bridge.certificate.empty()) root["bridge"]["certificate"] = site.bridge.certificate.string();
  if (!site.bridge.key.empty()) root["bridge"]["key"] = site.bridge.key.string();
  for (const std::string& origin : site.bridge.origins) root["bridge"]["origins"].push_back(origin);
  root["bridge"]["local_role"] = site.bridge.local_role;
  root["bridge"]["max_clients"] = site.bridge.max_clients;
  YAML::Emitter out;
  out.SetDoublePrecision(10);
  out << root;
  return out.c_str();
}

}  // namespace concord

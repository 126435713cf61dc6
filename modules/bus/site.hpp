#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "core/policy.hpp"

namespace concord {

/// What the site file says of one agent; agents it does not name get `Site::unlisted`.
struct AgentConfig {
  std::string kind = "unknown";
  int weight = 1;       ///< 1 to 1000
  double radius = 0.3;  ///< metres; as a robot on the grid
  double speed = 0.5;   ///< m/s along a path
  /// Its outline, "LENGTHxWIDTH" or "x y, x y, x y, ...", robot frame, metres; the planner reads it. Empty: a disc.
  std::string footprint;
  double turn_radius = 0.0;  ///< metres, with a footprint; 0: it turns in place
  /// Heights that it takes up, map z, metres; absent: the planner's band.
  std::optional<std::pair<double, double>> band;
};

/// What holds for the ground around all things of a class of labels, seen from above.
struct ClassTerms {
  double margin = 0.0;       ///< metres that robots keep from them, 0 to 10; 0: no more than from anything
  int cost = 0;              ///< within the cost's margin a metre costs so many more than elsewhere, 0 to 15
  double cost_margin = 0.0;  ///< metres around them, above the margin and at most 10; with a cost
};

/// The one YAML file of a site: a section per process, unknown keys are errors. Defaults stand here.
struct Site {
  std::string lcm_url = "udpm://239.255.76.67:7667?ttl=0";
  bool beyond_host = false;  ///< must be true for a ttl above 0: LCM has no authentication
  std::filesystem::path state = "state";
  double resolution = 0.05;  ///< metres

  std::map<std::string, AgentConfig> agents;
  AgentConfig unlisted;
  std::map<std::string, ClassTerms> classes;  ///< by name

  struct Stream {
    double bytes_per_second = 5e6;
  } stream;
  struct Ingest {
    std::int64_t max_agents = 64;
    std::int64_t max_known_voxels = 400'000'000;  ///< per agent
  } ingest;
  struct Merge {
    Policy policy = Policy::kMean;
  } merge;
  struct Planner {
    double zmin = 0.1, zmax = 1.8;  ///< height band, map z, metres
    double free_share = 0.5;        ///< of the band that must have been observed free
  } planner;
  /// Headsets and browsers. Beyond loopback only with TLS, and each client then needs a token.
  struct Bridge {
    std::string listen = "127.0.0.1";  ///< address; 0.0.0.0 or :: for all
    std::int64_t port = 8443;          ///< 0: any that is free
    bool tls = false;
    std::filesystem::path certificate;  ///< PEM; empty: STATE/bridge/cert.pem, which `concord cert` makes
    std::filesystem::path key;          ///< PEM; empty: STATE/bridge/key.pem
    std::vector<std::string> origins;   ///< pages from elsewhere that may connect, e.g. https://lab.example:8080
    std::string local_role = "edit";    ///< what clients on this machine may do: view, edit or robot
    std::int64_t max_clients = 64;
  } bridge;

  [[nodiscard]] const AgentConfig& agent(const std::string& id) const {
    const auto it = agents.find(id);
    return it != agents.end() ? it->second : unlisted;
  }
};

/// Start-up configuration that cannot be used; caught in `main`, printed as one line.
class ConfigError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// @throws ConfigError for a missing file, bad YAML, an unknown key or a value out of range; names file and line.
[[nodiscard]] Site load_site(const std::filesystem::path& file);

/// The same for the text of a site file; a state folder that is not absolute lies in `directory`. The error names no
/// file.
[[nodiscard]] Site parse_site(const std::string& yaml, const std::filesystem::path& directory);

/// The effective values, as YAML: what the process logs at its start.
[[nodiscard]] std::string to_yaml(const Site& site);

}  // namespace concord

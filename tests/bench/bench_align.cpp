#include <cmath>
#include <cstdio>
#include <exception>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "align_speed.hpp"
#include "align_tables.hpp"

namespace concord::bench {
namespace {

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

nlohmann::json report(const std::string& title, const Table& table) {
  nlohmann::json out;
  std::printf("%s\n  %-62s %6s %6s %9s %7s %7s  %s\n", title.c_str(), "", "asked", "found", "acc.right", "fooled",
              "ms p50", "reasons");
  for (const auto& [key, t] : table) {
    std::string reasons;
    for (const auto& [reason, count] : t.reasons) reasons += reason + " " + std::to_string(count) + " ";
    std::printf("  %-62s %6d %6d %9d %7d %7.0f  %s\n", key.c_str(), t.asked, t.found, t.accepted_right, t.fooled,
                median(t.ms), reasons.c_str());
    out[key] = {{"asked", t.asked},   {"found", t.found},   {"accepted_right", t.accepted_right},
                {"fooled", t.fooled}, {"ms", median(t.ms)}, {"reasons", t.reasons}};
  }
  std::fflush(stdout);
  return out;
}

/// Off by 0.9 m and 8 degrees for a building, by what a scan moves for a scan.
Transform race_guess(const Pair& pair) {
  if (pair.name == "registration") return Transform::Identity();
  Transform off = Transform::Identity();
  off.translate(Eigen::Vector3d(0.6, -0.6, 0.3));
  off.rotate(Eigen::AngleAxisd(8.0 * M_PI / 180.0, Eigen::Vector3d::UnitZ()));
  return off * pair.T_target_source;
}

/// How often as fast as `other` we are, at an error no larger than its own by over a millimetre; else 0.
double ratio(const std::vector<Timing>& timings, const std::string& ours, const std::string& other, int threads) {
  const auto find = [&](const std::string& method) -> const Timing* {
    for (const Timing& t : timings) {
      if (t.method == method && t.threads == threads) return &t;
    }
    return nullptr;
  };
  const Timing* us = find(ours);
  const Timing* them = find(other);
  if (us == nullptr || them == nullptr || us->miss.metres > them->miss.metres + 0.001) return 0.0;
  return them->ms / us->ms;
}

nlohmann::json race_all(const std::vector<Pair>& pairs, int rounds) {
  nlohmann::json out;
  std::vector<Method> methods = our_methods();
  for (const auto& more : {pcl_methods(), peer_methods()}) methods.insert(methods.end(), more.begin(), more.end());
  for (const Pair& pair : pairs) {
    if (pair.target.points.empty()) continue;
    const std::vector<Timing> timings = race(pair, race_guess(pair), methods, {1, 2}, rounds);
    std::printf("%s: %zu and %zu points\n", pair.name.c_str(), pair.target.points.size(), pair.source.points.size());
    for (const Timing& t : timings) {
      std::printf("  %-24s %d thread%s %8.1f ms   %.3f m %.2f degrees\n", t.method.c_str(), t.threads,
                  t.threads == 1 ? " " : "s", t.ms, t.miss.metres, t.miss.degrees);
      out[pair.name][t.method][std::to_string(t.threads)] = {
          {"ms", t.ms}, {"metres", t.miss.metres}, {"degrees", t.miss.degrees}};
    }
    std::fflush(stdout);
    const auto least = [&](const std::string& key, const std::string& ours, const std::string& other) {
      for (const int threads : {1, 2}) {
        const double r = ratio(timings, ours, other, threads);
        if (!out.contains(key) || r < out[key].get<double>()) out[key] = r;
      }
    };
    least("over_pcl_icp", "concord refine", "PCL ICP");
    least("over_pcl_icp_whole", "concord align, whole", "PCL ICP");
    least("over_pcl_planes", "concord refine", "PCL ICP, planes");
    if (!peer_methods().empty()) {
      least("over_peer", "concord refine", "small_gicp VGICP");
      least("over_peer_whole", "concord align, whole", "small_gicp VGICP");
    }
  }
  for (const auto& [key, value] : out.items()) {
    if (value.is_number()) std::printf("%s %.2f\n", key.c_str(), value.get<double>());
  }
  std::fflush(stdout);
  return out;
}

int main(int argc, char** argv) {
  CLI::App app{"Alignment on real maps: how often it finds the place, whether it is ever fooled, how fast it is."};
  Amount amount;
  int fooled = 60;
  int rounds = 5;
  bool json = false;
  app.add_option("--guesses", amount.guesses, "rough guesses a pair")->check(CLI::Range(0, 10000));
  app.add_option("--placements", amount.placements, "placements a pair without a guess")->check(CLI::Range(0, 1000));
  app.add_option("--fooled", fooled, "requests that have no answer")->check(CLI::Range(0, 100000));
  app.add_option("--rounds", rounds, "of the race; 0: none")->check(CLI::Range(0, 100));
  app.add_option("--threads", amount.threads, "for the tables")->check(CLI::Range(1, 64));
  app.add_flag("--json", json, "end with one line of JSON");
  CLI11_PARSE(app, argc, argv);
  try {
    const std::vector<Pair> pairs = real_pairs();
    const std::vector<Scene> rooms = quest_rooms();
    if (pairs.empty() || rooms.empty()) {
      throw std::runtime_error("no data in " + data_folder().string() + "; name the folder in CONCORD_DATA");
    }
    nlohmann::json out;
    if (rounds > 0) out = race_all(pairs, rounds);
    if (amount.guesses > 0) {
      out["pairs"] = report("Real pairs", success_on_pairs(pairs, amount));
      out["rooms"] = report("Rooms cut in two", success_on_rooms(rooms, amount));
      out["disturbed"] = report("Disturbed, overlap 50 to 70 %", success_disturbed(rooms, amount));
    }
    if (fooled > 0) {
      out["never_fooled"] = report("What has no answer", never_fooled(rooms, pairs, fooled, amount.threads));
    }
    if (json) std::printf("%s\n", out.dump().c_str());
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_align: %s\n", error.what());
    return 2;
  }
  return 0;
}

}  // namespace
}  // namespace concord::bench

int main(int argc, char** argv) { return concord::bench::main(argc, argv); }

#include <cstdio>
#include <exception>
#include <filesystem>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "edit_latency.hpp"
#include "network.hpp"

namespace concord::bench {
namespace {

constexpr std::int64_t kVoxels = 2'000'000;
constexpr std::int64_t kManyVoxels = 20'000'000;
constexpr const char* kMemory = "/dev/shm";

const std::vector<std::string> kMapOnly = {"ingest", "merge"};
const std::vector<std::string> kAll = {"ingest", "merge", "planner"};
const std::vector<Transform> kOneAgent = {Transform::Identity()};

/// One agent as it is, and one turned across it: a brick of one lies in up to eight of the other's.
std::vector<Transform> two_agents() {
  Transform turned = Transform::Identity();
  turned.linear() = Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  turned.translation() = Eigen::Vector3d(1.03, -0.52, 0.11);
  return {Transform::Identity(), turned};
}

void print(const char* what, const EditLatency& latency) {
  std::printf("%s, %.1f M voxels\n", what, static_cast<double>(latency.voxels) * 1e-6);
  std::printf("  bare LCM round trip   %7.0f us median, %7.0f us p99\n", latency.round_trip.p50,
              latency.round_trip.p99);
  std::printf("  edit to map change    %7.0f us median, %7.0f us p99: %.1f and %.1f median round trips\n",
              latency.edit.p50, latency.edit.p99, latency.edit.p50 / latency.round_trip.p50,
              latency.edit.p99 / latency.round_trip.p50);
  std::fflush(stdout);
}

int main(int argc, char** argv) {
  CLI::App app{"From one voxel's edit to the map's change, through real processes, against a bare LCM round trip."};
  std::string disk = std::filesystem::temp_directory_path();
  bool json = false;
  app.add_option("--disk", disk, "a folder on the disk whose share is stated apart");
  app.add_flag("--json", json, "end with one line of JSON");
  CLI11_PARSE(app, argc, argv);
  try {
    if (const std::string refusal = test::enter_private_network(); !refusal.empty()) {
      throw std::runtime_error("network namespaces are not permitted here: " + refusal);
    }
    const EditLatency usual = measure_edits({kVoxels, kOneAgent, kMapOnly}, kMemory);
    print("state in memory", usual);
    const EditLatency large = measure_edits({kManyVoxels, kOneAgent, kMapOnly}, kMemory);
    print("state in memory", large);
    const EditLatency on_disk = measure_edits({kVoxels, kOneAgent, kMapOnly}, disk);
    print(("state in " + disk).c_str(), on_disk);
    const EditLatency two = measure_edits({2 * kVoxels, two_agents(), kAll}, kMemory);
    print("state in memory, two agents across each other, and a planner", two);
    if (!json) return 0;
    const nlohmann::json out = {{"p50_over_rtt", usual.edit.p50 / usual.round_trip.p50},
                                {"p99_over_rtt", usual.edit.p99 / usual.round_trip.p50},
                                {"p50_over_rtt_20m", large.edit.p50 / large.round_trip.p50},
                                {"p99_over_rtt_20m", large.edit.p99 / large.round_trip.p50},
                                {"p50_over_rtt_two_agents", two.edit.p50 / two.round_trip.p50},
                                {"p99_over_rtt_two_agents", two.edit.p99 / two.round_trip.p50},
                                {"rtt_p50_us", usual.round_trip.p50},
                                {"rtt_p99_us", usual.round_trip.p99},
                                {"edit_p50_us", usual.edit.p50},
                                {"edit_p99_us", usual.edit.p99},
                                {"disk_edit_p50_us", on_disk.edit.p50},
                                {"disk_edit_p99_us", on_disk.edit.p99}};
    std::printf("%s\n", out.dump().c_str());
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_edit: %s\n", error.what());
    return 2;
  }
  return 0;
}

}  // namespace
}  // namespace concord::bench

int main(int argc, char** argv) { return concord::bench::main(argc, argv); }

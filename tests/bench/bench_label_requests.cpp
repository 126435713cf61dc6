#include <cstdio>
#include <exception>
#include <filesystem>
#include <stdexcept>
#include <string>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "edit_latency.hpp"
#include "network.hpp"

namespace concord::bench {
namespace {

constexpr std::int64_t kVoxels = 2'000'000;

void print(std::int32_t instances, std::int32_t classes, const LabelLatency& latency) {
  std::printf("%d instances, %d classes, %.1f M voxels\n", instances, classes,
              static_cast<double>(latency.voxels) * 1e-6);
  const auto row = [&](const char* what, const Latency& of) {
    std::printf("  %-22s %7.0f us median, %7.0f us p99: %.1f and %.1f median round trips\n", what, of.p50, of.p99,
                of.p50 / latency.round_trip.p50, of.p99 / latency.round_trip.p50);
  };
  row("bare LCM round trip", latency.round_trip);
  row("label", latency.label);
  row("take a label off", latency.take_off);
  row("delete the voxels", latency.remove);
  std::fflush(stdout);
}

int main(int argc, char** argv) {
  CLI::App app{"From a label request to its answer, through real processes, against a bare LCM round trip."};
  bool json = false;
  app.add_flag("--json", json, "end with one line of JSON");
  CLI11_PARSE(app, argc, argv);
  try {
    if (const std::string refusal = test::enter_private_network(); !refusal.empty()) {
      throw std::runtime_error("network namespaces are not permitted here: " + refusal);
    }
    nlohmann::json out;
    for (const auto& [instances, classes] : {std::pair(1000, 100), {10'000, 1000}}) {
      const LabelLatency latency = measure_labels(kVoxels, instances, classes, "/dev/shm");
      print(instances, classes, latency);
      out[std::to_string(instances)] = {{"rtt_p50_us", latency.round_trip.p50},
                                        {"label_p50_over_rtt", latency.label.p50 / latency.round_trip.p50},
                                        {"label_p99_over_rtt", latency.label.p99 / latency.round_trip.p50},
                                        {"take_off_p50_over_rtt", latency.take_off.p50 / latency.round_trip.p50},
                                        {"delete_p50_over_rtt", latency.remove.p50 / latency.round_trip.p50},
                                        {"delete_p99_over_rtt", latency.remove.p99 / latency.round_trip.p50}};
    }
    if (json) std::printf("%s\n", out.dump().c_str());
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_label_requests: %s\n", error.what());
    return 2;
  }
  return 0;
}

}  // namespace
}  // namespace concord::bench

int main(int argc, char** argv) { return concord::bench::main(argc, argv); }

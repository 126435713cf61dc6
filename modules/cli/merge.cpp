#include <memory>
#include <thread>

#include <nlohmann/json.hpp>

#include "cli/arguments.hpp"
#include "cli/command.hpp"
#include "cli/map_file.hpp"
#include "cli/numbers.hpp"
#include "core/compose.hpp"

namespace concord {
namespace {

struct Options {
  std::string a, b, out;
  std::string transform = "0 0 0 0 0 0 1";
  std::string policy = "mean";
  std::vector<int> weights = {1, 1};
};

Outcome merge(const Options& options, const Common& common) {
  const auto T_a_b = parse_transform(options.transform);
  if (!T_a_b) return fail(T_a_b.error());
  const auto a = load_map(options.a);
  if (!a) return fail(a.error());
  const auto b = load_map(options.b, a->resolution);
  if (!b) return fail(b.error());

  const std::array<Layer, 2> layers = {Layer{&a->map, Transform::Identity(), options.weights[0]},
                                       Layer{&b->map, *T_a_b, options.weights[1]}};
  if (!fits(layers[1], a->resolution)) {
    return fail(Exit::kUnusable, name(Code::kOutOfBounds),
                options.b + " would lie beyond the map's bounds there, " + format_number(kMaxVoxel * a->resolution, 0) +
                    " m from the origin of " + options.a);
  }
  const Policy policy = options.policy == "mean" ? Policy::kMean : Policy::kTable;
  const int threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  const MergedMap merged = compose(layers, {}, policy, a->resolution, threads);
  if (!options.out.empty()) {
    const auto saved = save_map(options.out, merged.values, a->resolution);
    if (!saved) return fail(saved.error());
  }
  const auto known = static_cast<std::int64_t>(merged.values.known_count());
  const auto occupied = static_cast<std::int64_t>(merged.values.occupied_count());
  const auto conflicting = static_cast<std::int64_t>(merged.conflicts.known_count());
  const std::string hash = hex(digest(merged.values));
  common.print({{"resolution", a->resolution},
                {"occupied", occupied},
                {"free", known - occupied},
                {"conflicting", conflicting},
                {"digest", hash}},
               "occupied     " + format_count(occupied) + " voxels\nfree         " + format_count(known - occupied) +
                   "\nconflicting  " + format_count(conflicting) +
                   (options.out.empty() ? "" : "\nwritten to   " + options.out));
  return Exit::kDone;
}

}  // namespace

void add_merge(Program& program) {
  auto options = std::make_shared<Options>();
  CLI::App& command = program.add("merge", "merges two map files as the stack merges submaps",
                                  [options](const Common& common) { return merge(*options, common); });
  command.add_option("a", options->a, ".bt or .ot; its frame and resolution are the result's")->required();
  command.add_option("b", options->b, ".bt or .ot")->required();
  command.add_option("--transform", options->transform, "T_A_B as \"x y z qx qy qz qw\": b's points into a's frame");
  command.add_option("--policy", options->policy, "mean (SLAM-XR) or table (HAC-SLAM)")
      ->check(CLI::IsMember({"mean", "table"}))
      ->capture_default_str();
  command.add_option("--weights", options->weights, "of a and of b, 1 to 1000")
      ->expected(2)
      ->check(CLI::Range(1, 1000));
  command.add_option("--out", options->out, "writes the result: .bt or .ot");
}

}  // namespace concord

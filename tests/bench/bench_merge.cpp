#include <cstdio>
#include <exception>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "merge_figures.hpp"

namespace concord::bench {
namespace {

void print(const std::string& name, const MergeFigures& f) {
  std::printf("%s\n", name.c_str());
  std::printf("  %.2f M known voxels in both, %.0f a brick\n", static_cast<double>(f.voxels) * 1e-6,
              f.voxels_per_brick);
  std::printf("  all of it     %8.1f M voxels/s, the papers' loop %.2f: %.0f times as fast\n", f.mvoxels_per_s,
              f.naive_mvoxels_per_s, f.full_ratio);
  std::printf("  1 %% changed   %8.3f ms (%zu bricks): %.0f times as fast as the papers' full pass\n", f.update_ms,
              f.update_bricks, f.update_ratio);
  std::printf("  memory        %8.2f bytes a voxel, the papers' trees %.1f: 1/%.1f\n", f.bytes_per_voxel,
              f.naive_bytes_per_voxel, f.memory_ratio);
  std::fflush(stdout);
}

nlohmann::json to_json(const MergeFigures& f) {
  return {{"full_ratio", f.full_ratio},
          {"update_ratio", f.update_ratio},
          {"memory_ratio", f.memory_ratio},
          {"mvoxels_per_s", f.mvoxels_per_s},
          {"naive_mvoxels_per_s", f.naive_mvoxels_per_s},
          {"voxels_per_brick", f.voxels_per_brick}};
}

MergeFigures run(MergeCase merge_case) {
  const MergeFigures figures = measure(merge_case);
  print(merge_case.name, figures);
  return figures;
}

int main(int argc, char** argv) {
  CLI::App app{"Merging under a rotation, against the papers' loop on OctoMap; one thread, the same data."};
  std::vector<std::string> maps;
  std::string transform;
  bool json = false;
  app.add_option("maps", maps, "two .bt or .ot files; without them two made-up scans of a hall")->expected(0, 2);
  app.add_option("--transform", transform, "T_A_B as \"x y z qx qy qz qw\"; by default turned by 0.3 rad and more");
  app.add_flag("--json", json, "end with one line of JSON");
  CLI11_PARSE(app, argc, argv);
  try {
    nlohmann::json out;
    if (maps.size() == 2) {
      out = to_json(run(load_case(maps[0], maps[1], parse_transform(transform))));
    } else if (maps.empty() && transform.empty()) {
      out = to_json(run(dense_case()));
      out["sparse"] = to_json(run(sparse_case()));
    } else {
      throw std::runtime_error("two maps or none; --transform only with maps");
    }
    if (json) std::printf("%s\n", out.dump().c_str());
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_merge: %s\n", error.what());
    return 2;
  }
  return 0;
}

}  // namespace
}  // namespace concord::bench

int main(int argc, char** argv) { return concord::bench::main(argc, argv); }

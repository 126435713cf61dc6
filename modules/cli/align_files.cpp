#include "cli/align_files.hpp"

#include <chrono>
#include <filesystem>
#include <thread>
#include <utility>

#include <nlohmann/json.hpp>

#include "align/align.hpp"
#include "align/prepare.hpp"
#include "cli/align_page.hpp"
#include "cli/align_report.hpp"
#include "cli/cloud_file.hpp"
#include "cli/extension.hpp"
#include "cli/map_file.hpp"

namespace concord {
namespace {

constexpr double kMeshSpacing = 0.025;  // half a voxel of the finest resolution of a cloud
int all_threads() { return static_cast<int>(std::max(1U, std::thread::hardware_concurrency())); }

/// A file as it was read.
struct Loaded {
  std::optional<OctomapImport> map;
  std::vector<Eigen::Vector3f> cloud;
};

Result<Loaded> load(const std::string& file) {
  const std::string extension = extension_of(file);
  if (extension != ".pcd" && extension != ".ply") {
    auto map = load_map(file);
    if (!map) return tl::unexpected(map.error());
    return Loaded{std::move(*map), {}};
  }
  auto points = read_cloud(file, kMeshSpacing);
  if (!points) return tl::unexpected(points.error());
  return Loaded{std::nullopt, std::move(*points)};
}

Result<AlignMap> prepare(Loaded loaded, int threads) {
  return loaded.map ? prepare_map(loaded.map->map, loaded.map->resolution, threads)
                    : prepare_map(std::move(loaded.cloud), threads);
}

Result<void> draw(const AlignFiles& files, const AlignMap& target, const AlignMap& source, const Alignment& found) {
  AlignPage page{files.target, files.source,          found.message,        &target,
                 &source,      Transform::Identity(), found.T_target_source};
  if (files.T_target_source) page.T_target_source_before = *files.T_target_source;
  return write_align_page(page, files.picture);
}

tl::unexpected<Failure> fail_on(const std::string& file, const Error& error) {
  const bool is_named = error.message.starts_with(file);
  return fail({error.code, (is_named ? "" : file + ": ") + error.message});
}

}  // namespace

bool is_alignable_file(const std::string& name) {
  const std::string extension = extension_of(name);
  return extension == ".bt" || extension == ".ot" || extension == ".pcd" || extension == ".ply";
}

Outcome align_files(const AlignFiles& files, const Common& common) {
  auto source_file = load(files.source);
  if (!source_file) return fail_on(files.source, source_file.error());
  auto target_file = load(files.target);
  if (!target_file) return fail_on(files.target, target_file.error());
  const auto start = std::chrono::steady_clock::now();
  const int threads = all_threads();
  const auto source = prepare(std::move(*source_file), threads);
  if (!source) return fail_on(files.source, source.error());
  const auto target = prepare(std::move(*target_file), threads);
  if (!target) return fail_on(files.target, target.error());
  Alignment found = align(*target, *source, files.T_target_source, threads);
  const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
  found.ms = took.count();
  common.print(to_json(found), to_words(found));
  const Exit exit = found.accepted() ? Exit::kDone : Exit::kRefused;
  if (files.picture.empty()) return exit;
  const auto drawn = draw(files, *target, *source, found);
  return drawn ? exit : say_undrawn({Exit::kUnusable, name(drawn.error().code), drawn.error().message}, exit);
}

}  // namespace concord

// Labelling and taking off in a small and in a large world: what it costs goes by the voxels touched.

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "semantic/labels/keep_out.hpp"
#include "semantic/labels/label_view.hpp"
#include "semantic/semantic_store.hpp"

namespace concord::bench {
namespace {

using Clock = std::chrono::steady_clock;

/// An instance is a block of 5 x 5 x 8 voxels: 200, so that 10,000 of them are two million.
constexpr std::int32_t kSide = 5, kHeight = 8;

std::vector<VoxelIndex> block(std::int32_t number) {
  std::vector<VoxelIndex> out;
  const std::int32_t x0 = number % 100 * kSide, y0 = number / 100 * kSide;
  for (std::int32_t x = 0; x < kSide; ++x) {
    for (std::int32_t y = 0; y < kSide; ++y) {
      for (std::int32_t z = 0; z < kHeight; ++z) out.push_back({x0 + x, y0 + y, z});
    }
  }
  return out;
}

struct Figures {
  double label_p50 = 0, label_p99 = 0, take_off_p50 = 0, take_off_p99 = 0, stored_label_p50 = 0;
};

double percentile(std::vector<double> all, double share) {
  std::sort(all.begin(), all.end());
  return all[std::min(all.size() - 1, static_cast<std::size_t>(share * static_cast<double>(all.size())))];
}

class World {
 public:
  World(std::int32_t instances, std::int32_t classes) : store_(file(), 0.05), classes_(classes) {
    BrickMasks occupied;
    for (std::int32_t i = 0; i < instances + kMore; ++i) occupied.insert(masks_of(block(i)));
    map_ = occupied.to_map(kOccupied);
    for (std::int32_t i = 0; i < instances; ++i) (void)label(i, false);
    next_ = instances;
  }

  Figures measure() {
    Figures out;
    std::vector<double> labels, stored, offs;
    for (std::int32_t i = 0; i < kMore; ++i) {
      labels.push_back(label(next_ + i, false));
      offs.push_back(change(LabelRequest::Op::kTakeOff, last_));
      stored.push_back(label(next_ + i, true));
    }
    out.label_p50 = percentile(labels, 0.5), out.label_p99 = percentile(labels, 0.99);
    out.take_off_p50 = percentile(offs, 0.5), out.take_off_p99 = percentile(offs, 0.99);
    out.stored_label_p50 = percentile(stored, 0.5);
    return out;
  }
  [[nodiscard]] std::size_t voxels() const { return map_.known_count(); }

  /// Milliseconds that it takes to say what is within 100 m.
  double within() {
    LabelQuery query;
    query.kind = LabelQuery::Kind::kWithin;
    query.radius = 100;
    const auto start = Clock::now();
    if (view_.answer(query)->empty()) throw std::runtime_error("nothing shows");
    return 1e-3 * microseconds_since(start);
  }
  /// The first so many are taken off one by one, and labelled anew. @pre made with one class.
  void take_off_and_label(std::int32_t many) {
    for (std::int32_t i = 0; i < many; ++i) {
      (void)change(LabelRequest::Op::kTakeOff, {1, static_cast<std::uint32_t>(i + 1)});
      (void)label(i, false);
    }
  }
  /// So many of those that were labelled last come to be another class's.
  void reassign(std::int32_t many) {
    LabelRequest other;
    other.name = "other";
    (void)ask(other, block(next_), false);
    const std::uint32_t last = labels_.classes().at(1).highest();
    for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(many); ++i) {
      (void)change(LabelRequest::Op::kReassign, {1, last - i}, "other");
    }
  }
  /// Milliseconds that it takes to say the zones around all that shows, and again when one brick of it has changed.
  [[nodiscard]] std::pair<double, double> keep_clear() const {
    Outlines outlines;
    const auto zones = [&](const std::vector<BrickIndex>& changed, double margin) {
      const auto start = Clock::now();
      for (const BrickIndex index : changed) {
        Outlines::InBrick now;
        for (const auto& [of, voxels] : view_.in_brick(index)) now.emplace(of, outline_of(voxels, 0.05));
        outlines.set(index, std::move(now));
      }
      std::vector<KeptClearOf> things;
      for (const auto& [of, outline] : outlines.all()) things.push_back({std::to_string(of.instance), outline, margin});
      if (keep_out_zones(things, 0.05).empty()) throw std::runtime_error("nothing shows");
      return 1e-3 * microseconds_since(start);
    };
    const auto bricks = view_.shown().sorted_bricks();
    const double all = zones(bricks, 0.5);
    outlines.set(bricks.front(), {});
    return {all, zones({bricks.front()}, 0.5)};
  }
  /// Milliseconds that it takes to take off all of a class.
  double take_off_class() { return 1e-3 * change(LabelRequest::Op::kTakeOff, {1, 0}); }

 private:
  static double microseconds_since(Clock::time_point start) {
    return std::chrono::duration<double, std::micro>(Clock::now() - start).count();
  }
  double change(LabelRequest::Op op, InstanceId of, const std::string& name = "") {
    LabelRequest request;
    request.op = op;
    request.of = of;
    request.name = name;
    return ask(request, {}, false);
  }
  static constexpr std::int32_t kMore = 200;

  static std::filesystem::path file() {
    const auto path = std::filesystem::temp_directory_path() / "concord-bench-labels.db";
    for (const char* end : {"", "-wal", "-shm"}) std::filesystem::remove(path.string() + end);
    return path;
  }
  double label(std::int32_t number, bool stored) {
    LabelRequest request;
    request.name = "class " + std::to_string(number % classes_);
    return ask(request, block(number), stored);
  }
  /// Microseconds from the request to what shows.
  double ask(LabelRequest request, const std::vector<VoxelIndex>& voxels, bool stored) {
    request.id = std::to_string(++asked_);
    const auto start = Clock::now();
    auto what = labels_.check(request, voxels);
    if (!what) throw std::runtime_error(what.error().message);
    const LabelCorrection correction{labels_.revision() + 1, request.id, "bench", 0, 1, std::move(*what)};
    if (stored && !store_.put(correction)) throw std::runtime_error("cannot store");
    BrickSet touched;
    labels_.apply(correction, touched);
    for (const auto& [tile, bricks] : touched.sorted()) {
      for (std::uint64_t bits = bricks; bits != 0; bits &= bits - 1)
        view_.refresh(brick_at(tile, std::countr_zero(bits)));
    }
    last_ = labels_.find(request.id)->of;
    return microseconds_since(start);
  }

  SemanticStore store_;
  std::int32_t classes_, next_ = 0;
  int asked_ = 0;
  InstanceId last_;
  BrickMap map_;
  Labels labels_{0.05};
  LabelView view_{labels_, map_, 0.05};
};

nlohmann::json after_many_changes() {
  World world(10'000, 1);
  nlohmann::json out;
  out["within_ms"] = world.within();
  const auto [all_zones, changed_zones] = world.keep_clear();
  out["zones_ms"] = all_zones;
  out["zones_after_a_change_ms"] = changed_zones;
  std::printf("zones around all of them: %.1f ms, after a brick changed %.1f ms\n", all_zones, changed_zones);
  world.take_off_and_label(9'000);
  out["within_after_take_offs_ms"] = world.within();
  world.reassign(5'000);
  out["within_after_reassigning_ms"] = world.within();
  out["take_off_class_ms"] = world.take_off_class();
  std::printf("10000 instances: within %.1f ms, after 9000 take-offs %.1f ms, then 5000 reassigned %.1f ms\n",
              out["within_ms"].get<double>(), out["within_after_take_offs_ms"].get<double>(),
              out["within_after_reassigning_ms"].get<double>());
  std::printf("take off all of a class that had 19000: %.1f ms\n", out["take_off_class_ms"].get<double>());
  return out;
}

int main(int argc, char** argv) {
  CLI::App app{"Labelling 200 voxels and taking a label off, in a small and in a large world."};
  bool json = false;
  app.add_flag("--json", json, "end with one line of JSON");
  CLI11_PARSE(app, argc, argv);
  nlohmann::json out;
  for (const auto& [instances, classes] : {std::pair(100, 10), {10'000, 1'000}}) {
    World world(instances, classes);
    const Figures f = world.measure();
    std::printf(
        "%6d instances, %4d classes, %zu voxels: label %.0f us (p99 %.0f), on disk %.0f; take off %.0f us (p99 %.0f)\n",
        instances, classes, world.voxels(), f.label_p50, f.label_p99, f.stored_label_p50, f.take_off_p50,
        f.take_off_p99);
    out[std::to_string(instances)] = {
        {"label_us", f.label_p50}, {"stored_label_us", f.stored_label_p50}, {"take_off_us", f.take_off_p50}};
  }
  out["many_changes"] = after_many_changes();
  if (json) std::printf("%s\n", out.dump().c_str());
  return 0;
}

}  // namespace
}  // namespace concord::bench

int main(int argc, char** argv) { return concord::bench::main(argc, argv); }

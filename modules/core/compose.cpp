#include "core/compose.hpp"

#include <algorithm>
#include <cassert>
#include <future>

#include "core/tile_puller.hpp"

namespace concord {
namespace {

/// What is the same for every tile of one fold.
struct Plan {
  std::span<const Layer> layers;
  std::vector<LatticeTransform> transforms;
  const PinMap& pins;
  Policy policy;

  Plan(std::span<const Layer> all, const PinMap& pinned, Policy chosen, double resolution)
      : layers(all), pins(pinned), policy(chosen) {
    transforms.reserve(layers.size());
    for (const Layer& layer : layers) {
      assert(layer.map != nullptr && layer.weight >= 1 && layer.weight <= 1000);
      transforms.emplace_back(layer.T_map_layer, resolution);
    }
  }
};

/// A layer's share in one brick: a whole brick where the lattices coincide, else what was pulled.
struct Share {
  const Brick* brick = nullptr;
  const Key* keys = nullptr;
  std::int32_t weight = 1;
};

void apply_pins(const PinBrick& pins, Key* keys, VoxelMask& conflicts) {
  for (int word = 0; word < 8; ++word) {
    for (std::uint64_t bits = pins.occupied[word]; bits != 0; bits &= bits - 1) {
      keys[word * 64 + std::countr_zero(bits)] = key_of(kPinnedOccupied);
    }
    for (std::uint64_t bits = pins.free[word]; bits != 0; bits &= bits - 1) {
      keys[word * 64 + std::countr_zero(bits)] = key_of(kPinnedFree);
    }
    conflicts[word] &= ~(pins.occupied[word] | pins.free[word]);
  }
}

/// Folds tile after tile; keeps the memory that this takes.
class TileFolder {
 public:
  /// Calls `emit(FoldedBrick)` for each brick in `entry`, in order of position; with `only_known`, not for bricks of
  /// which no layer and no pin knows anything.
  template <class Emit>
  void fold(const Plan& plan, const BrickSet::Entry& entry, bool only_known, Emit&& emit) {
    std::uint64_t bricks = pull(plan, entry);
    if (!only_known || !plan.pins.empty()) bricks = entry.bricks;
    for (; bricks != 0; bricks &= bricks - 1) {
      FoldedBrick folded = fold_brick(plan, entry.tile, std::countr_zero(bricks));
      if (!only_known || !folded.values.empty()) emit(std::move(folded));
    }
  }

 private:
  /// Returns the bricks of which any layer may know something.
  std::uint64_t pull(const Plan& plan, const BrickSet::Entry& entry) {
    const std::size_t count = plan.layers.size();
    if (pulled_.size() < count) pulled_.resize(count);
    std::uint64_t bricks = 0;
    for (std::size_t i = 0; i < count; ++i) {
      puller_.pull(*plan.layers[i].map, plan.transforms[i], entry.tile, entry.bricks, pulled_[i]);
      bricks |= pulled_[i].bricks;
    }
    return bricks;
  }

  void find_shares(const Plan& plan, int local) {
    shares_.clear();
    for (std::size_t i = 0; i < plan.layers.size(); ++i) {
      const LayerTile& tile = pulled_[i];
      if ((tile.bricks >> local & 1) == 0) continue;
      const Brick* brick = tile.is_whole ? tile.whole[local] : nullptr;
      shares_.push_back({brick, tile.is_whole ? nullptr : tile.keys[local].data(), plan.layers[i].weight});
    }
  }

  FoldedBrick fold_brick(const Plan& plan, TileIndex tile, int local) {
    FoldedBrick out{brick_at(tile, local), {}, {}};
    find_shares(plan, local);
    const PinBrick* pins = plan.pins.empty() ? nullptr : plan.pins.find(out.index);
    if (shares_.empty() && pins == nullptr) return out;
    if (shares_.size() == 1 && pins == nullptr) {
      out.values = shares_[0].brick != nullptr ? *shares_[0].brick : pack(shares_[0].keys);
      return out;
    }
    KeyBrick keys;
    combine(plan.policy, keys, out.conflicts);
    if (pins != nullptr) apply_pins(*pins, keys.data(), out.conflicts);
    out.values = pack(keys.data());
    return out;
  }

  void combine(Policy policy, KeyBrick& out, VoxelMask& conflicts) {
    if (expanded_.size() < shares_.size()) expanded_.resize(shares_.size());
    keys_.clear();
    weights_.clear();
    for (std::size_t i = 0; i < shares_.size(); ++i) {
      if (shares_[i].brick != nullptr) expand(*shares_[i].brick, expanded_[i].data());
      keys_.push_back(shares_[i].brick != nullptr ? expanded_[i].data() : shares_[i].keys);
      weights_.push_back(shares_[i].weight);
    }
    const int count = static_cast<int>(shares_.size());
    if (policy == Policy::kMean) {
      brick_kernels().mean(keys_.data(), weights_.data(), count, out.data(), conflicts);
    } else {
      brick_kernels().table(keys_.data(), count, out.data(), conflicts);
    }
  }

  TilePuller puller_;
  std::vector<LayerTile> pulled_;  // by layer
  std::vector<Share> shares_;
  std::vector<KeyBrick> expanded_;
  std::vector<const Key*> keys_;
  std::vector<std::int32_t> weights_;
};

/// Making a folder costs as much as folding a hundred bricks, so that each thread keeps its own.
TileFolder& tile_folder() {
  thread_local TileFolder folder;
  return folder;
}

/// Calls `work(first, last, part)` for equal parts of 0 to `count`, each on its own thread, and waits for all.
/// @throws what `work` throws: there may not be memory for the map.
template <class Work>
void in_parts(std::size_t count, int parts, Work&& work) {
  const auto begin = [&](int part) { return count * part / parts; };
  std::vector<std::future<void>> others;
  for (int part = 1; part < parts; ++part) {
    others.push_back(std::async(std::launch::async, [&, part] { work(begin(part), begin(part + 1), part); }));
  }
  work(begin(0), begin(1), 0);
  for (std::future<void>& other : others) other.get();
}

Brick conflict_brick(const VoxelMask& conflicts) { return Brick::uniform(conflicts, kOccupied); }

/// The tiles that the layers and pins touch, all of their bricks.
std::vector<BrickSet::Entry> touched_tiles(const Plan& plan) {
  BrickSet touched;
  for (std::size_t i = 0; i < plan.layers.size(); ++i) {
    for (const TileIndex tile : plan.layers[i].map->sorted_tiles()) plan.transforms[i].touch(tile, touched);
  }
  for (const BrickIndex index : plan.pins.sorted_bricks()) {
    if (in_bounds(index)) touched.insert(index);
  }
  std::vector<BrickSet::Entry> tiles = touched.sorted();
  for (BrickSet::Entry& entry : tiles) entry.bricks = ~std::uint64_t{0};
  return tiles;
}

struct FoldedTile {
  TileIndex index;
  Tile values;
  Tile conflicts;
};

FoldedTile fold_tile(const Plan& plan, const BrickSet::Entry& entry, std::vector<Brick>& values,
                     std::vector<Brick>& conflicts) {
  FoldedTile out{entry.tile, {}, {}};
  values.clear();
  conflicts.clear();
  tile_folder().fold(plan, entry, true, [&](FoldedBrick folded) {
    const std::uint64_t bit = std::uint64_t{1} << local_of(folded.index);
    values.push_back(std::move(folded.values));
    out.values.present |= bit;
    if (folded.conflicts == VoxelMask{}) return;
    conflicts.push_back(conflict_brick(folded.conflicts));
    out.conflicts.present |= bit;
  });
  // Of the right size, not of what growing left.
  out.values.bricks.assign(std::make_move_iterator(values.begin()), std::make_move_iterator(values.end()));
  out.conflicts.bricks.assign(std::make_move_iterator(conflicts.begin()), std::make_move_iterator(conflicts.end()));
  return out;
}

}  // namespace

bool fits(const Layer& layer, double resolution) {
  const LatticeTransform lattice(layer.T_map_layer, resolution);
  bool inside = true;
  layer.map->for_each_brick([&](BrickIndex index, const Brick&) { inside = inside && lattice.keeps_in_bounds(index); });
  return inside;
}

std::vector<FoldedBrick> fold(std::span<const Layer> layers, const PinMap& pins, Policy policy, double resolution,
                              const BrickSet& dirty, int threads) {
  const Plan plan(layers, pins, policy, resolution);
  std::vector<BrickSet::Entry> tiles = dirty.sorted();
  std::erase_if(tiles, [](const BrickSet::Entry& entry) { return !in_bounds(origin_of(entry.tile)); });
  std::vector<std::vector<FoldedBrick>> parts(std::max(threads, 1));
  in_parts(tiles.size(), static_cast<int>(parts.size()), [&](std::size_t first, std::size_t last, int part) {
    for (std::size_t i = first; i < last; ++i) {
      tile_folder().fold(plan, tiles[i], false, [&](FoldedBrick folded) { parts[part].push_back(std::move(folded)); });
    }
  });
  for (std::size_t part = 1; part < parts.size(); ++part) {
    std::move(parts[part].begin(), parts[part].end(), std::back_inserter(parts[0]));
  }
  return std::move(parts[0]);
}

bool apply(FoldedBrick folded, MergedMap& map) {
  const bool conflicts_changed = map.conflicts.set(folded.index, conflict_brick(folded.conflicts));
  return map.values.set(folded.index, std::move(folded.values)) || conflicts_changed;
}

MergedMap compose(std::span<const Layer> layers, const PinMap& pins, Policy policy, double resolution, int threads,
                  const std::stop_token& stop) {
  const Plan plan(layers, pins, policy, resolution);
  const std::vector<BrickSet::Entry> tiles = touched_tiles(plan);
  std::vector<std::vector<FoldedTile>> parts(std::max(threads, 1));
  in_parts(tiles.size(), static_cast<int>(parts.size()), [&](std::size_t first, std::size_t last, int part) {
    std::vector<Brick> values;
    std::vector<Brick> conflicts;
    for (std::size_t i = first; i < last && !stop.stop_requested(); ++i) {
      parts[part].push_back(fold_tile(plan, tiles[i], values, conflicts));
    }
  });
  MergedMap out;
  for (std::vector<FoldedTile>& part : parts) {
    for (FoldedTile& tile : part) {
      out.values.set(tile.index, std::move(tile.values));
      out.conflicts.set(tile.index, std::move(tile.conflicts));
    }
  }
  return out;
}

}  // namespace concord

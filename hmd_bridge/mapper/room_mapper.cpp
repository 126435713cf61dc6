#include "mapper/room_mapper.hpp"

#include <algorithm>
#include <cmath>

#include "core/decimal.hpp"
#include "core/ray.hpp"
#include "mapper/triangle_cells.hpp"

namespace concord::hmd {
namespace {

using Met = std::unordered_map<BrickIndex, VoxelMask, IndexHash>;

bool contains(const Met& met, VoxelIndex voxel) {
  const auto it = met.find(brick_of(voxel));
  const auto local = static_cast<std::size_t>(local_of(voxel));
  return it != met.end() && (it->second[local / 64] >> (local % 64) & 1) != 0;
}

LogOdds log_odds_of(double p) {
  if (p >= 1) return kOccupied;
  const double value =
      std::clamp(std::log(p / (1 - p)) * 1024, static_cast<double>(kFree), static_cast<double>(kOccupied));
  return static_cast<LogOdds>(std::lround(value));
}

Result<void> check_sequence(std::int64_t sequence, std::int64_t next) {
  if (next == 0 && sequence != 0) {
    return refuse(concord::Code::kBadFrame,
                  "nothing of this frame is held here any more; send the whole room again, from sequence 0");
  }
  if (sequence >= next) return {};
  return refuse(Code::kStale, "this sequence was sent before; the next is " + std::to_string(next));
}

}  // namespace

Result<std::vector<VoxelIndex>> RoomMapper::cells_of(const MeshPart& part, std::size_t& budget) const {
  std::vector<VoxelIndex> cells;
  const float bound = static_cast<float>(kMaxVoxel * resolution_ * 0.99);
  for (const auto& triangle : part.triangles) {
    TriangleCells::Corners corners;
    for (std::size_t i = 0; i < 3; ++i) {
      const Eigen::Vector3f& p = part.vertices[triangle[i]];
      if (p.cwiseAbs().maxCoeff() > bound) return refuse(Code::kOutOfBounds, "a mesh reaches beyond any map");
      corners[i] = p.cast<double>() / resolution_;
    }
    if (!TriangleCells::append(corners, budget, cells)) {
      return refuse(Code::kTooLarge,
                    "a mesh meets more cells than may be; send the room in parts, or only what is near");
    }
  }
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  return cells;
}

bool RoomMapper::reached(VoxelIndex voxel, const Eigen::Vector3d& sensor) const {
  return (centre_of(voxel, resolution_) - sensor).squaredNorm() <= kReach * kReach;
}

void RoomMapper::end_sequence() {
  next_sequence_ = 0;
  meshes_.clear();
  met_cells_ = 0;
}

Result<void> RoomMapper::take(const MeshLook& look, std::int64_t sequence) {
  if (const auto fresh = check_sequence(sequence, next_sequence_); !fresh) return fresh;
  const Eigen::Vector3d sensor = look.T_own_sensor.translation();
  if (sensor.cwiseAbs().maxCoeff() > kMaxVoxel * resolution_ - 2 * kReach)
    return refuse(Code::kOutOfBounds, "the sensor is beyond any map");

  std::map<std::uint32_t, std::vector<VoxelIndex>> fresh;
  std::size_t in_all = met_cells_, budget = kMaxLookCells, meshes = meshes_.size();
  for (const MeshPart& part : look.parts) {
    auto cells = cells_of(part, budget);
    if (!cells) return tl::unexpected(std::move(cells.error()));
    in_all += cells->size();
    if (!meshes_.contains(part.number)) ++meshes;
    fresh[part.number] = std::move(*cells);
  }
  if (in_all > kMaxCells || meshes > kMaxMeshes)
    return refuse(Code::kTooLarge, "all meshes together meet more cells than may be");
  if (cells_.size() > kMaxBricks) return refuse(Code::kTooLarge, "the map of this headset is full; reset it");

  next_sequence_ = sequence + 1;
  for (auto& [number, cells] : fresh) {
    met_cells_ -= meshes_[number].size();
    met_cells_ += cells.size();
    if (cells.empty()) {
      meshes_.erase(number);
    } else {
      meshes_[number] = std::move(cells);
    }
  }
  Met met;
  std::vector<VoxelIndex> ends;
  for (const auto& [number, cells] : meshes_) {
    for (const VoxelIndex voxel : cells) {
      if (!reached(voxel, sensor) || contains(met, voxel)) continue;
      const auto local = static_cast<std::size_t>(local_of(voxel));
      met[brick_of(voxel)][local / 64] |= std::uint64_t{1} << (local % 64);
      ends.push_back(voxel);
    }
  }
  judge(met, sensor);
  const std::size_t step = ends.size() / kMaxRays + 1;
  std::vector<VoxelIndex> chosen;
  for (std::size_t i = static_cast<std::size_t>(sequence) % step; i < ends.size(); i += step) chosen.push_back(ends[i]);
  cast(met, chosen, sensor);
  for (auto& [index, stale] : changed_) {
    if (stale) render(index);
    stale = false;
  }
  return {};
}

/// Every cell that is met gains; every voxel within reach that exists and is not met loses.
void RoomMapper::judge(const Met& met, const Eigen::Vector3d& sensor) {
  for (const auto& [index, mask] : met) {
    Cells& cells = cells_.try_emplace(index).first->second;
    for (std::size_t word = 0; word < 8; ++word) {
      for (std::uint64_t bits = mask[word]; bits != 0; bits &= bits - 1) {
        std::uint8_t& cell = cells[word * 64 + static_cast<std::size_t>(std::countr_zero(bits))];
        if (cell == kFull) continue;
        cell = static_cast<std::uint8_t>(std::min<int>(std::max<int>(cell, kBegin) + kHit, kFull));
        changed_[index] = true;
      }
    }
  }
  const auto low = brick_of(voxel_of((sensor.array() - kReach).matrix(), resolution_));
  const auto high = brick_of(voxel_of((sensor.array() + kReach).matrix(), resolution_));
  for (auto& [index, cells] : cells_) {
    if (index.x < low.x || index.y < low.y || index.z < low.z || index.x > high.x || index.y > high.y ||
        index.z > high.z)
      continue;
    for (int local = 0; local < kBrickVoxels; ++local) {
      std::uint8_t& cell = cells[static_cast<std::size_t>(local)];
      const VoxelIndex voxel = voxel_at(index, local);
      if (cell < kExists || contains(met, voxel) || !reached(voxel, sensor)) continue;
      cell = static_cast<std::uint8_t>(cell - kMiss);
      if (cell < kExists) cell = kUnknownCell;
      changed_[index] = true;
    }
  }
}

void RoomMapper::cast(const Met& met, const std::vector<VoxelIndex>& ends, const Eigen::Vector3d& sensor) {
  const Eigen::Vector3d start = sensor / resolution_;
  for (const VoxelIndex end : ends) {
    bool clear = true;
    walk_ray(start, centre_of(end, 1.0), [&](VoxelIndex voxel) {
      if (!clear || contains(met, voxel)) {
        clear = false;
        return;
      }
      std::uint8_t& cell = cells_.try_emplace(brick_of(voxel)).first->second[static_cast<std::size_t>(local_of(voxel))];
      if (cell >= kExists || cell == kFreeCell) return;  // what exists goes by losing, not at once
      cell = kFreeCell;
      changed_[brick_of(voxel)] = true;
    });
  }
}

/// The brick as others see it: voxels that exist, by their percentage, and free ones.
void RoomMapper::render(BrickIndex index) {
  const Cells& cells = cells_.at(index);
  DenseBrick dense;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    dense[i] = cells[i] >= kExists ? log_odds_of(cells[i] / 100.0) : cells[i] == kFreeCell ? kFree : kUnknown;
  }
  const Brick* before = map_.find(index);
  if (before != nullptr) occupied_ -= before->occupied_count();
  Brick brick = Brick::from_dense(dense);
  occupied_ += brick.occupied_count();
  map_.set(index, std::move(brick));
}

Result<void> RoomMapper::take(const VoxelLook& look, std::int64_t sequence) {
  if (const auto fresh = check_sequence(sequence, next_sequence_); !fresh) return fresh;
  if (std::abs(look.resolution - resolution_) > 1e-9) {
    return refuse(Code::kBadResolution, "voxels must be " + decimal(resolution_) + " m wide, as the map's");
  }
  const auto any = [](const ChunkBits& bits) {
    return std::any_of(bits.begin(), bits.end(), [](std::uint8_t b) { return b != 0; });
  };
  if (!std::any_of(look.chunks.begin(), look.chunks.end(),
                   [&](const VoxelChunk& c) { return any(c.occupied) || any(c.free); })) {
    return refuse(Code::kEmpty, "no voxel is occupied or free");
  }
  if (map_.brick_count() + look.chunks.size() * 8 > kMaxBricks)
    return refuse(Code::kTooLarge, "the map of this headset is full; reset it");
  next_sequence_ = sequence + 1;
  const LogOdds occupied = log_odds_of(look.p_occupied), free = log_odds_of(look.p_free);
  for (const VoxelChunk& chunk : look.chunks) {
    for (int part = 0; part < 8; ++part) {
      const BrickIndex index{chunk.chunk.x * 2 + (part & 1), chunk.chunk.y * 2 + (part >> 1 & 1),
                             chunk.chunk.z * 2 + (part >> 2)};
      DenseBrick dense;
      dense.fill(kUnknown);
      const Brick* before = map_.find(index);
      if (before != nullptr) before->to_dense(dense);
      for (int local = 0; local < kBrickVoxels; ++local) {
        const int x = (part & 1) * 8 + (local & 7), y = (part >> 1 & 1) * 8 + (local >> 3 & 7),
                  z = (part >> 2) * 8 + (local >> 6);
        const auto bit = static_cast<std::size_t>(x + 16 * y + 256 * z);
        const auto is = [&](const ChunkBits& bits) { return (bits[bit / 8] >> (bit % 8) & 1) != 0; };
        if (is(chunk.occupied)) {
          dense[static_cast<std::size_t>(local)] = occupied;
        } else if (is(chunk.free)) {
          dense[static_cast<std::size_t>(local)] = free;
        }
      }
      if (before != nullptr) occupied_ -= before->occupied_count();
      Brick brick = Brick::from_dense(dense);
      occupied_ += brick.occupied_count();
      if (map_.set(index, std::move(brick))) changed_[index] = false;
    }
  }
  return {};
}

std::vector<BrickIndex> RoomMapper::take_changed() {
  std::vector<BrickIndex> changed;
  for (const auto& [index, stale] : changed_) changed.push_back(index);
  changed_.clear();
  return changed;
}

}  // namespace concord::hmd

#include "semantic/labels/label_view.hpp"

#include <algorithm>
#include <bit>
#include <set>

namespace concord {
namespace {

constexpr std::size_t kFew = 100;  ///< instances that are looked up one by one

}  // namespace

bool LabelView::refresh(BrickIndex index) {
  DenseBrick dense;
  dense.fill(kUnknown);
  const Brick* map = map_.find(index);
  const VoxelMask occupied = map != nullptr ? map->occupied() : VoxelMask{};
  for (const Labels::Share& share : labels_.shares(index, occupied)) {
    for (int word = 0; word < 8; ++word) {
      for (std::uint64_t bits = share.voxels[word]; bits != 0; bits &= bits - 1) {
        const auto [slot, is_new] = slots_.try_emplace(share.of, static_cast<std::int32_t>(by_slot_.size()));
        if (is_new) by_slot_.push_back(share.of);
        dense[static_cast<std::size_t>(word * 64 + std::countr_zero(bits))] = value_of_slot(slot->second);
      }
    }
  }
  return shown_.set(index, Brick::from_dense(dense));
}

std::vector<LabelSlot> LabelView::slots() const {
  std::vector<LabelSlot> out;
  for (std::size_t i = 0; i < by_slot_.size(); ++i) {
    out.push_back({static_cast<std::int32_t>(i), by_slot_[i], labels_.classes().at(by_slot_[i].label).name});
  }
  return out;
}

std::vector<VoxelIndex> LabelView::voxels_of(InstanceId of) const {
  std::vector<VoxelIndex> out;
  if (of.instance == 0) {
    for (const auto& [id, voxels] : by_instance(of.label)) out.insert(out.end(), voxels.begin(), voxels.end());
    std::ranges::sort(out);
    return out;
  }
  const auto slot = slots_.find(of);
  if (slot == slots_.end()) return out;
  const LogOdds value = value_of_slot(slot->second);
  for (const auto& [tile, bricks] : labels_.bricks_of(of).sorted()) {
    for (std::uint64_t bits = bricks; bits != 0; bits &= bits - 1) {
      const BrickIndex index = brick_at(tile, std::countr_zero(bits));
      const Brick* brick = shown_.find(index);
      if (brick == nullptr) continue;
      brick->for_each([&](int local, LogOdds at) {
        if (at == value) out.push_back(voxel_at(index, local));
      });
    }
  }
  std::ranges::sort(out);
  return out;
}

LabelInstance LabelView::instance(InstanceId of) const { return summary(of, voxels_of(of)); }

LabelInstance LabelView::summary(InstanceId of, const std::vector<VoxelIndex>& voxels) const {
  LabelInstance out{of, labels_.classes().at(of.label).name, static_cast<std::int64_t>(voxels.size()), {}, {}};
  if (voxels.empty()) return out;
  out.min = out.max = voxels.front();
  std::array<std::int64_t, 3> sum{};
  for (const VoxelIndex v : voxels) {
    out.min = {std::min(out.min.x, v.x), std::min(out.min.y, v.y), std::min(out.min.z, v.z)};
    out.max = {std::max(out.max.x, v.x), std::max(out.max.y, v.y), std::max(out.max.z, v.z)};
    sum[0] += v.x, sum[1] += v.y, sum[2] += v.z;
  }
  for (int i = 0; i < 3; ++i) {
    out.centroid[i] =
        (static_cast<double>(sum[static_cast<std::size_t>(i)]) / static_cast<double>(voxels.size()) + 0.5) *
        resolution_;
  }
  return out;
}

std::map<InstanceId, std::vector<VoxelIndex>> LabelView::by_instance(ClassId label) const {
  return by_instance([label](InstanceId of) { return label == 0 || of.label == label; });
}

std::map<InstanceId, std::vector<VoxelIndex>> LabelView::by_instance(
    const std::function<bool(InstanceId)>& wanted) const {
  std::vector<bool> is_wanted;
  for (const InstanceId& of : by_slot_) is_wanted.push_back(wanted(of));
  std::map<InstanceId, std::vector<VoxelIndex>> out;
  for (const BrickIndex index : shown_.sorted_bricks()) {
    shown_.find(index)->for_each([&](int local, LogOdds value) {
      const auto slot = static_cast<std::size_t>(slot_of_value(value));
      if (is_wanted[slot]) out[by_slot_[slot]].push_back(voxel_at(index, local));
    });
  }
  return out;
}

std::map<InstanceId, std::vector<VoxelIndex>> LabelView::in_brick(BrickIndex index) const {
  std::map<InstanceId, std::vector<VoxelIndex>> out;
  const Brick* brick = shown_.find(index);
  if (brick == nullptr) return out;
  brick->for_each([&](int local, LogOdds value) {
    out[by_slot_[static_cast<std::size_t>(slot_of_value(value))]].push_back(voxel_at(index, local));
  });
  return out;
}

std::vector<VoxelIndex> LabelView::border_of(const std::vector<VoxelIndex>& voxels) const {
  std::vector<VoxelIndex> out;
  for (const VoxelIndex v : voxels) {
    for (const VoxelIndex d : {VoxelIndex{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}) {
      const VoxelIndex beside{v.x + d.x, v.y + d.y, v.z + d.z};
      if (in_bounds(beside) && is_free(map_.at(beside))) out.push_back(beside);
    }
  }
  std::ranges::sort(out);
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

std::vector<LabelInstance> LabelView::within(const LabelQuery& query) const {
  const VoxelIndex low = voxel_of(query.p_map.array() - query.radius, resolution_);
  const VoxelIndex high = voxel_of(query.p_map.array() + query.radius, resolution_);
  std::set<InstanceId> near;
  for (const BrickIndex index : shown_.sorted_bricks()) {
    const VoxelIndex first = origin_of(index);
    const auto apart = [](std::int32_t from, std::int32_t a, std::int32_t b) { return from + 7 < a || from > b; };
    if (apart(first.x, low.x, high.x) || apart(first.y, low.y, high.y) || apart(first.z, low.z, high.z)) continue;
    shown_.find(index)->for_each([&](int local, LogOdds value) {
      const double away = (centre_of(voxel_at(index, local), resolution_) - query.p_map).norm();
      if (away <= query.radius) near.insert(by_slot_[static_cast<std::size_t>(slot_of_value(value))]);
    });
  }
  std::vector<LabelInstance> out;
  if (near.size() <= kFew) {
    for (const InstanceId of : near) out.push_back(instance(of));
    return out;
  }
  for (const auto& [of, voxels] : by_instance([&](InstanceId one) { return near.contains(one); })) {
    out.push_back(summary(of, voxels));
  }
  return out;
}

Result<std::vector<LabelInstance>> LabelView::answer(const LabelQuery& query) const {
  auto out = found(query);
  if (!out || out->empty()) return out;
  for (LabelInstance& one : *out) {
    const auto model = labels_.model_of(one.of);
    if (!model) continue;
    one.asset = model->asset;
    one.T_map_asset = model->T_map_asset;
  }
  return out;
}

Result<std::vector<LabelInstance>> LabelView::found(const LabelQuery& query) const {
  using Kind = LabelQuery::Kind;
  std::vector<LabelInstance> out;
  if (query.kind == Kind::kWithin) return within(query);
  if (query.kind == Kind::kClasses) {
    for (const auto& [label, of_class] : labels_.classes()) {
      out.push_back({{label, 0}, of_class.name, 0, {}, {}});
    }
    return out;
  }
  if (query.kind == Kind::kAt) {
    if (query.p_map.cwiseAbs().maxCoeff() >= kMaxVoxel * resolution_) return out;
    const LogOdds value = shown_.at(voxel_of(query.p_map, resolution_));
    if (is_known(value)) out.push_back(instance(by_slot_[static_cast<std::size_t>(slot_of_value(value))]));
    return out;
  }
  ClassId label = 0;
  if (query.kind != Kind::kAll) {
    const auto known = labels_.class_called(query.name);
    if (!known) return refuse(Code::kNotFound, "no class " + query.name + "; see: concord labels");
    label = *known;
  }
  for (const auto& [of, voxels] : by_instance(label)) {
    out.push_back(summary(of, query.kind == Kind::kBorder ? border_of(voxels) : voxels));
  }
  return out;
}

}  // namespace concord

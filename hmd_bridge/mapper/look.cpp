#include "mapper/look.hpp"

namespace concord::hmd {
namespace {

Result<void> take(RoomMapper& mapper, PackedFrame packed) {
  const auto frame = unpack(std::move(packed));
  if (!frame) return tl::unexpected(frame.error());
  const std::int64_t sequence = frame->head.revision;
  if (frame->head.kind == FrameKind::kMesh) {
    const auto look = read_mesh(*frame);
    return look ? mapper.take(*look, sequence) : tl::unexpected(look.error());
  }
  const auto look = read_voxels(*frame);
  return look ? mapper.take(*look, sequence) : tl::unexpected(look.error());
}

}  // namespace

Judged judge(RoomMapper& mapper, PackedFrame frame) {
  Judged judged{take(mapper, std::move(frame)), {}, mapper.occupied(), mapper.bytes()};
  for (const BrickIndex index : mapper.take_changed()) {
    const Brick* brick = mapper.map().find(index);
    judged.changed.emplace_back(index, brick != nullptr ? *brick : Brick());
  }
  return judged;
}

}  // namespace concord::hmd

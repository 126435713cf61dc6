#include "mapper/room_mapper.hpp"
#include "must.hpp"
#include "protocol/frame.hpp"

// Binary frames from clients: refused, or within the limits, and a headset's map takes them or stays as it is.

using namespace concord;
using namespace concord::hmd;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto frame = read_frame({data, size});
  if (!frame) return 0;
  fuzz::must(frame->payload.size() <= kMaxInflatedBytes);
  RoomMapper mapper(0.05);
  switch (frame->head.kind) {
    case FrameKind::kBlock:
      if (const auto block = read_block(*frame)) fuzz::must(block_payload(*block) == frame->payload);
      break;
    case FrameKind::kForget:
      if (const auto blocks = read_forget(*frame)) fuzz::must(forget_payload(*blocks) == frame->payload);
      break;
    case FrameKind::kMesh:
      if (const auto look = read_mesh(*frame)) {
        const bool taken = mapper.take(*look, frame->head.revision).has_value();
        fuzz::must(taken || mapper.map().empty());
      }
      break;
    case FrameKind::kVoxels:
      if (const auto look = read_voxels(*frame)) {
        const bool taken = mapper.take(*look, frame->head.revision).has_value();
        fuzz::must(taken || mapper.map().empty());
      }
      break;
    default: break;
  }
  return 0;
}

#include "core/brick_codec.hpp"
#include "must.hpp"

using namespace concord;

/// Bytes are a run of bricks that would be written as just these bytes, or are refused without being taken.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  ByteSpan in(data, size);
  while (!in.empty()) {
    const ByteSpan before = in;
    const Result<Brick> brick = read_brick(in);
    if (!brick) {
      fuzz::must(in.size() == before.size());
      break;
    }
    Bytes again;
    append_brick(again, *brick);
    fuzz::must(again.size() <= kMaxBrickBytes);
    fuzz::must(std::equal(again.begin(), again.end(), before.begin(), before.end() - in.size()));
  }
  ByteSpan varints(data, size);
  while (const auto value = read_varint(varints)) fuzz::must(unzigzag(zigzag(unzigzag(*value))) == unzigzag(*value));
  return 0;
}

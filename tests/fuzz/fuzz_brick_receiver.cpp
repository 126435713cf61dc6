#include <spdlog/spdlog.h>

#include <string>

#include "bus/brick_stream.hpp"
#include "bus/lockstep_bus.hpp"
#include "core/brick_codec.hpp"
#include "must.hpp"

using namespace concord;

namespace {

/// Small numbers mostly, so that messages meet; now and then any number.
std::int64_t number(ByteSpan& in) {
  const std::uint8_t small = read_le<std::uint8_t>(in).value_or(1);
  return small < 250 ? small : read_le<std::int64_t>(in).value_or(1);
}

std::string frame(ByteSpan& in) { return std::string(1, static_cast<char>('a' + (number(in) & 1))); }

Bytes chunk(ByteSpan& in) {
  const std::size_t size = std::min<std::size_t>(read_le<std::uint16_t>(in).value_or(0) % 2048, in.size());
  Bytes bytes(in.begin(), in.begin() + static_cast<std::ptrdiff_t>(size));
  in = in.subspan(size);
  return bytes;
}

}  // namespace

/// Any sequence of packets and digests that a decoder lets through, with time passing: the copy stays what was handed
/// on, nothing is handed on twice, holes are never negative.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  spdlog::set_level(spdlog::level::off);
  ByteSpan in(data, size);
  LockstepBus bus(1'000'000);
  Counters counters;
  BrickMap copy;
  BrickReceiver receiver(bus, counters, {"in/a", 0.05, 1000},
                         {[&](const std::string&) { copy.clear(); },
                          [&](BrickIndex index, Brick brick) {
                            fuzz::must(in_bounds(index));
                            fuzz::must(copy.set(index, std::move(brick)));
                          },
                          [&] { copy.clear(); }});
  bool closed = false;
  while (!in.empty()) {
    switch (number(in) % 6) {
      case 0:
      case 1: {
        BrickPacket packet{0, number(in), frame(in), 0.05, number(in), number(in), 0, {}};
        packet.count = static_cast<std::int32_t>(number(in));
        packet.data = chunk(in);
        if (const auto read = decode<BrickPacket>(encode(packet))) receiver.on_packet(*read);
        break;
      }
      case 2: {  // a good one
        BrickPacket packet{0, 1 + number(in) % 3, frame(in), 0.05, 1 + number(in) % 20, 0, 1, {}};
        packet.last_version = packet.first_version + number(in) % 4;
        append_varint(packet.data, 0);
        for (int i = 0; i < 3; ++i) append_varint(packet.data, static_cast<std::uint64_t>(number(in)) % 4);
        const std::uint64_t known = static_cast<std::uint64_t>(number(in));
        append_brick(packet.data, known == 0 ? Brick() : Brick::uniform({known}, kOccupied));
        if (const auto read = decode<BrickPacket>(encode(packet))) receiver.on_packet(*read);
        break;
      }
      case 3: {
        const std::int64_t revision = number(in);
        const bool equal = number(in) % 2 == 0;
        const BrickDigest digest_of_copy{0,
                                         number(in),
                                         frame(in),
                                         0.05,
                                         revision,
                                         static_cast<std::int64_t>(copy.brick_count()),
                                         equal ? digest(copy) : digest(copy) + 1};
        const auto read = decode<BrickDigest>(encode(digest_of_copy));
        if (!read) break;
        receiver.on_digest(*read);
        break;
      }
      case 4: bus.advance_to(bus.now() + 10'000 * (number(in) & 0xFF)); break;
      case 5:
        if (!closed && number(in) == 7) {
          receiver.close_frame();
          copy.clear();
          closed = true;
        }
        break;
    }
    fuzz::must(receiver.missing() >= 0);
    if (receiver.synced()) fuzz::must(receiver.missing() == 0);
  }
  return 0;
}

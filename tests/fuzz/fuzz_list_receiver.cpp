#include <spdlog/spdlog.h>

#include <string>

#include "bus/list_stream.hpp"
#include "bus/lockstep_bus.hpp"
#include "must.hpp"

using namespace concord;

namespace {

const ListChannels kChannels("out/zones");

std::uint8_t number(ByteSpan& in) { return read_le<std::uint8_t>(in).value_or(0); }

std::vector<Zone> zones(std::uint8_t count, std::uint8_t kind) {
  std::vector<Zone> out;
  for (int i = 0; i < count; ++i) {
    Zone& zone = out.emplace_back();
    zone.name = std::string(1 + kind % 70, static_cast<char>('a' + i % 26)) + std::to_string(i);
    zone.volume = Box{{0, 0, 0}, {1, 1.0 + kind, 1}};
  }
  return out;
}

}  // namespace

/// Any sequence of an honest sender's messages and of anybody's, with time passing: what is handed on differs from what
/// was before, is never more than a list may hold, and within a few seconds of honesty it is the sender's.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  spdlog::set_level(spdlog::level::off);
  ByteSpan in(data, size);
  LockstepBus bus(1'000'000);
  Counters counters;
  std::size_t handed_on = 0;
  ListDigest digest;
  bus.subscribe(kChannels.digest, [&](const std::string&, ByteSpan bytes) {
    if (const auto read = decode<ListDigest>(bytes)) digest = *read;
  });
  ListReceiver<Zone> receiver(bus, counters, "out/zones", [&](const std::vector<Zone>& items) {
    fuzz::must(items.size() <= kMaxZones);
    handed_on = items.size();
  });
  ListSender<Zone> sender(bus, counters, "out/zones", 5e6);
  std::size_t honest = 0;
  sender.set({});
  while (!in.empty()) {
    switch (number(in) % 6) {
      case 0: {
        const auto list = zones(number(in), number(in));
        honest = list.size();
        sender.set(list);
        break;
      }
      case 1: {  // of the list that is wanted, in any case
        const ListPart<Zone> part{digest.content,
                                  number(in) % 8,
                                  number(in) % 2 == 0 ? digest.parts : number(in),
                                  zones(number(in) % 64, number(in)),
                                  {}};
        bus.publish(kChannels.parts, encode(part, 1));
        break;
      }
      case 2: bus.publish(kChannels.digest, encode(ListDigest{number(in), number(in) * 5}, 1)); break;
      case 3: bus.publish(kChannels.need, encode(ListRequest{digest.content}, 1)); break;
      case 4: {
        const std::size_t wanted = number(in);
        const std::size_t length = std::min(wanted, in.size());
        bus.publish(kChannels.parts, in.first(length));
        in = in.subspan(length);
        break;
      }
      case 5: bus.advance_to(bus.now() + 5'000 * number(in)); break;
    }
    bus.deliver();
    fuzz::must(receiver.items().size() == handed_on);
  }
  bus.advance_to(bus.now() + 5'000'000);
  fuzz::must(receiver.synced());
  fuzz::must(receiver.items().size() == honest);
  return 0;
}

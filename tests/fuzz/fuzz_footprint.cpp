#include <string_view>

#include "must.hpp"
#include "planner/footprint/footprint_text.hpp"
#include "planner/footprint/standing_room.hpp"

using namespace concord;

namespace {

/// An open square with one blocked cell in its middle.
const OpenGrid& grid() {
  static const OpenGrid made = [] {
    OpenGrid g(40, 40);
    for (int y = 0; y < 40; ++y)
      for (int x = 0; x < 40; ++x) g.set({x, y}, x != 20 || y != 20);
    return g;
  }();
  return made;
}

void use(const Footprint& footprint) {
  fuzz::must(footprint.polygon().size() >= 3 && footprint.polygon().size() <= Footprint::kMaxVertices);
  fuzz::must(footprint.inscribed() >= Footprint::kLeast && footprint.inscribed() <= footprint.circumscribed());
  fuzz::must(footprint.circumscribed() <= Footprint::kMaxReach);
  fuzz::must(!footprint.parts().empty());
  static const DistanceField field(grid(), 30);
  const StandingRoom room(grid(), field, footprint);
  fuzz::must(!room.stands({{20.5, 20.5}, 0}));
  const Move move{3, 1};
  if (room.moves({{8, 8}, 0}, move)) fuzz::must(room.stands({{8, 8}, 0}));
}

}  // namespace

/// Any text as a footprint and as a pose, as the command line and requests hand them on.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  if (const auto footprint = read_footprint(text)) use(*footprint);
  if (const auto pose = read_pose(text)) fuzz::must(pose->is_finite());
  return 0;
}

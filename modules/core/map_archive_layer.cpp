#include <bit>
#include <cassert>
#include <string>
#include <utility>

#include "core/brick_codec.hpp"
#include "core/map_archive_parts.hpp"
#include "core/requests.hpp"

namespace concord::archive {
namespace {

/// Tiles in the order of TileIndex: counted x slowest, z fastest.
constexpr std::int32_t kTilesHalf = kMaxVoxel / kTileVoxelSide;
constexpr std::uint64_t kTilesSide = 2 * kTilesHalf;
constexpr std::uint64_t kTiles = kTilesSide * kTilesSide * kTilesSide;

std::uint64_t number_of(TileIndex tile) {
  const auto part = [](std::int32_t c) { return static_cast<std::uint64_t>(c + kTilesHalf); };
  return (part(tile.x) * kTilesSide + part(tile.y)) * kTilesSide + part(tile.z);
}

TileIndex tile_at(std::uint64_t number) {
  const auto part = [](std::uint64_t c) { return static_cast<std::int32_t>(c % kTilesSide) - kTilesHalf; };
  return {part(number / (kTilesSide * kTilesSide)), part(number / kTilesSide), part(number)};
}

tl::unexpected<Error> bad_layer(const std::string& agent) {
  return malformed("the layer of " + agent + " is not one; save it again");
}

/// What a layer says it holds.
struct Announced {
  std::uint64_t bricks = 0;
  std::uint64_t known = 0;
};

/// The bricks of one tile. Refused: bytes that are none.
Result<Tile> read_tile(FieldReader& in, std::uint64_t present, const std::string& agent) {
  Tile tile;
  tile.present = present;
  tile.bricks.reserve(static_cast<std::size_t>(std::popcount(present)));
  for (std::uint64_t bits = present; bits != 0; bits &= bits - 1) {
    auto brick = read_brick(in.rest());
    if (!brick || brick->empty()) return bad_layer(agent);
    tile.bricks.push_back(std::move(*brick));
  }
  return tile;
}

Result<BrickMap> read_tiles(FieldReader& in, Announced left, bool keep, const std::string& agent) {
  BrickMap map;
  for (std::uint64_t next = 0; !in.rest().empty();) {
    const std::uint64_t skipped = in.varint();
    const auto present = in.integer<std::uint64_t>();
    const auto count = static_cast<std::uint64_t>(std::popcount(present));
    if (!in.ok() || count == 0 || count > left.bricks || skipped >= kTiles - next) return bad_layer(agent);
    auto tile = read_tile(in, present, agent);
    if (!tile) return tl::unexpected(tile.error());
    for (const Brick& brick : tile->bricks) {
      const auto known = static_cast<std::uint64_t>(brick.known_count());
      if (known > left.known) return bad_layer(agent);
      left.known -= known;
    }
    left.bricks -= count;
    if (keep) map.set(tile_at(next + skipped), std::move(*tile));
    next += skipped + 1;
  }
  if (left.bricks != 0 || left.known != 0) return bad_layer(agent);
  return map;
}

}  // namespace

Result<void> check(const LayerHead& head) {
  if (!is_name(head.agent) || !is_name(head.kind) || !is_name(head.frame_id)) {
    return refuse(Code::kBadName, "a layer's agent, kind and frame are 1 to 40 of A-Z a-z 0-9 . _ -");
  }
  if (head.weight < 1 || head.weight > 1000) return refuse(Code::kBadRequest, "weight must be 1 to 1000");
  return {};
}

void append_layer(Bytes& out, const LayerHead& head, const BrickMap& bricks) {
  append_text(out, head.agent);
  append_text(out, head.kind);
  append_text(out, head.frame_id);
  append_le(out, head.incarnation);
  append_le(out, static_cast<std::uint16_t>(head.weight));
  append_le(out, std::uint64_t{bricks.brick_count()});
  append_le(out, std::uint64_t{bricks.known_count()});
  std::uint64_t next = 0;
  for (const TileIndex index : bricks.sorted_tiles()) {
    const Tile& tile = *bricks.find(index);
    append_varint(out, number_of(index) - next);
    append_le(out, tile.present);
    for (const Brick& brick : tile.bricks) append_brick(out, brick);
    next = number_of(index) + 1;
  }
}

Result<SavedLayer> read_layer(ByteSpan content, const MapArchiveOptions& options, Room& room) {
  FieldReader in(content);
  SavedLayer layer;
  layer.head.agent = in.text();
  layer.head.kind = in.text();
  layer.head.frame_id = in.text();
  layer.head.incarnation = in.integer<std::int64_t>();
  layer.head.weight = in.integer<std::uint16_t>();
  const auto bricks = in.integer<std::uint64_t>();
  const auto known = in.integer<std::uint64_t>();
  if (!in.ok()) return malformed("the head of a layer is cut short; save it again");
  if (auto fine = check(layer.head); !fine) return malformed(fine.error().message);
  if (known > options.known_voxels) {
    return refuse(Code::kTooLarge, "map file: the layer of " + layer.head.agent + " has " + std::to_string(known) +
                                       " voxels; raise ingest.max_known_voxels in the site file");
  }
  if (auto fits = room.take_layer(bricks, known); !fits) return tl::unexpected(fits.error());
  auto map = read_tiles(in, {bricks, known}, options.keep_bricks, layer.head.agent);
  if (!map) return tl::unexpected(map.error());
  layer.bricks = std::move(*map);
  return layer;
}

}  // namespace concord::archive

#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "planner/lattice/open_grid.hpp"

namespace concord {

/// Which open cells hang together, so that "there is no way" is said at once. Over sides only: a step over a
/// corner needs both cells beside it, so it joins nothing that sides do not.
/// Runs of cells are joined within tiles of 64 x 64 to parts; what meets at their borders joins these.
class Components {
 public:
  /// Takes the grid as it is now. It must outlive this and change only along with `update`.
  explicit Components(const OpenGrid& grid);

  /// Cells in `window` have changed. Costs the tiles that it touches, and with the next question one look at every
  /// part of every tile.
  void update(const Window& window);

  /// Whether there is a way. @pre both are open.
  [[nodiscard]] bool connected(Cell a, Cell b);

 private:
  static constexpr int kTile = 64;
  /// Parts on both sides of a border that meet.
  struct Link {
    std::uint16_t here, there;
  };
  struct Tile {
    std::array<std::uint64_t, kTile> rows{};
    std::array<std::uint16_t, kTile> first_run{};  ///< runs in the rows below
    std::vector<std::uint16_t> part;               ///< by run
    std::vector<Link> right, above;                ///< to the next tile's parts
    std::uint32_t parts = 0;
    std::uint32_t offset = 0;  ///< of its parts among all

    [[nodiscard]] std::uint16_t part_at(int x, int y) const;
  };

  void join_runs(int tx, int ty);
  void link(int tx, int ty);
  void join_tiles();
  [[nodiscard]] Tile& tile_at(int tx, int ty) { return tiles_[static_cast<std::size_t>(ty) * across_ + tx]; }
  [[nodiscard]] std::uint32_t part_of(Cell cell) const;

  const OpenGrid& grid_;
  int across_, up_;  ///< tiles
  std::vector<Tile> tiles_;
  std::vector<std::uint32_t> parent_;  ///< of all tiles' parts
  bool is_joined_ = false;
};

}  // namespace concord

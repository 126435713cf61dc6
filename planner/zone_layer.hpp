#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "core/corrections.hpp"
#include "planner/grid.hpp"
#include "planner/zone_cells.hpp"

namespace concord {

/// What it costs besides to be in the cells of a column of bricks: so many times what a free one costs; by x + 8 y.
using ColumnCosts = std::array<std::uint8_t, 64>;

/// Where people forbade robots to go, where they allowed contact, and where they would rather not have them, as cells
/// beside the grid, which stays as it was observed. The rules are in README.md. Map data, not a rated safety function.
class ZoneLayer {
 public:
  /// A zone of more cells, or one that together with those before it in the order of names has more than kMaxCells, is
  /// taken as the rectangle around it; an allow-contact zone as none. Both are on the safe side.
  static constexpr std::int64_t kMaxZoneCells = 1'000'000;
  static constexpr std::int64_t kMaxCells = 16'000'000;

  /// No zones, for any grid.
  ZoneLayer() = default;
  ZoneLayer(double resolution, const Band& band) : resolution_(resolution), band_(band) {}

  /// What cells cost beside all corridors.
  static constexpr std::uint8_t kBesideCorridors = 15;

  /// Where robots are more restricted than before, or pay more (`blocked`), or less (`freed`); ascending.
  struct Change {
    std::vector<ColumnChange> columns;
    bool anywhere = false;  ///< beyond `columns`, a zone that is taken as a rectangle came, went or changed
  };
  /// The zones from now on. Counts those that are new or changed, and draws those of them that are taken
  /// cell by cell: kMaxCells at most in all; the rest costs nothing. What it leads to depends on
  /// `zones` alone, not on what was before.
  Change set(std::span<const Zone> zones);

  [[nodiscard]] bool has_no_go() const { return has_no_go_; }
  [[nodiscard]] bool has_contact() const { return has_contact_; }
  [[nodiscard]] bool has_costs() const { return has_costly_ || has_corridors_; }
  [[nodiscard]] ColumnCosts costs(BrickIndex column) const;
  /// Cells of a column of bricks that lie in a no-go zone.
  [[nodiscard]] std::uint64_t no_go(BrickIndex column) const;
  /// Those in an allow-contact zone; some may lie in a no-go zone, too.
  [[nodiscard]] std::uint64_t contact(BrickIndex column) const;
  /// The first no-go zone, by name, that holds the cell; null where none does.
  [[nodiscard]] const std::string* no_go_at(Cell cell) const;
  /// The no-go zones that lie in a column of bricks, by name.
  [[nodiscard]] std::vector<std::string> no_go_names(BrickIndex column) const;
  struct Near {
    std::string name;
    double distance;  ///< of its nearest cell, in cells
  };
  /// The no-go zone nearest to `p` (in cells), if one is within `reach`.
  [[nodiscard]] std::optional<Near> nearest_no_go(const Eigen::Vector2d& p, double reach) const;

  [[nodiscard]] std::size_t size() const { return zones_.size(); }
  /// Of zones that are not taken cell by cell.
  [[nodiscard]] std::vector<std::string> coarse() const;

 private:
  struct Drawn {
    Zone zone;
    bool fits = false;        ///< it has `count` cells, at most kMaxZoneCells
    bool is_settled = false;  ///< what is below is right
    bool is_fine = false;     ///< taken cell by cell
    std::int64_t count = 0;
    ZoneCells cells;       ///< none unless is_fine
    CellRectangle around;  ///< of one that is not

    [[nodiscard]] bool is(Zone::Kind kind) const { return zone.kind == kind; }
    [[nodiscard]] bool is_no_go() const { return is(Zone::Kind::kNoGo); }
    [[nodiscard]] bool has_cells() const { return is_fine ? !cells.columns.empty() : around.low.x <= around.high.x; }
    [[nodiscard]] std::uint64_t plane(BrickIndex column) const {
      return is_fine ? cells.plane(column) : around.plane(column);
    }
  };
  struct Planes {
    std::uint64_t no_go = 0, contact = 0;
  };
  /// Of a column that costly zones or corridors lie in.
  struct Price {
    ColumnCosts costly{};
    std::uint64_t corridor = 0;

    [[nodiscard]] bool operator==(const Price&) const = default;
    void add(const Drawn& zone, BrickIndex column);
    [[nodiscard]] std::uint8_t at(int local, bool has_corridors) const {
      const bool is_beside = has_corridors && (corridor >> local & 1) == 0;
      return std::max<std::uint8_t>(costly[static_cast<std::size_t>(local)], is_beside ? kBesideCorridors : 0);
    }
  };
  /// What `set` has found out about so far.
  struct Dirty {
    std::vector<BrickIndex> columns;
    bool anywhere = false;
    void add(const Drawn& drawn);
  };

  [[nodiscard]] Drawn counted(Zone zone) const;
  [[nodiscard]] std::vector<Drawn> match(std::vector<Zone> zones, Dirty& dirty);
  void settle(Drawn& zone, std::int64_t& left, Dirty& dirty) const;
  void take_prices(const std::vector<const Drawn*>& near, ColumnChange& change);
  [[nodiscard]] std::vector<ColumnChange> recompute(std::vector<BrickIndex> dirty);

  double resolution_ = 1.0;
  Band band_;
  std::vector<Drawn> zones_;  ///< by name
  std::unordered_map<BrickIndex, Planes, IndexHash> planes_;
  std::vector<CellRectangle> rectangles_;  ///< of no-go zones that are not taken cell by cell
  bool has_no_go_ = false;
  bool has_contact_ = false;
  std::unordered_map<BrickIndex, Price, IndexHash> prices_;
  std::vector<Drawn> large_;  ///< costly zones and corridors that are not taken cell by cell
  bool has_costly_ = false;
  bool has_corridors_ = false;
};

[[nodiscard]] const ZoneLayer& no_zones();

}  // namespace concord

#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "planner/lattice/open_grid.hpp"

namespace concord {

/// The four directions along the axes, counter-clockwise with y up: east, north, west, south. The diagonal 4 + d lies
/// between d and the next.
inline constexpr std::array<int, 8> kDx{1, 0, -1, 0, 1, -1, -1, 1};
inline constexpr std::array<int, 8> kDy{0, 1, 0, -1, 1, 1, -1, -1};

/// A cell with a 16-bit address, that of the grid plus one: the border counts.
struct Spot {
  std::uint16_t x = 0, y = 0;
  bool operator==(const Spot&) const = default;
};
[[nodiscard]] inline Spot spot_of(Cell cell) {
  return {static_cast<std::uint16_t>(cell.x + 1), static_cast<std::uint16_t>(cell.y + 1)};
}
[[nodiscard]] inline Cell cell_of(Spot spot) { return {spot.x - 1, spot.y - 1}; }

/// The jump points of a grid and what can be reached from each without turning twice: the graph that jump point search
/// walks (Harabor & Grastien 2014, block-wise scans, no corner cutting, points on diagonals left out), kept from one
/// query to the next (as Harabor, Uras, Stuckey & Koenig 2019 do, whole). What leaves a point is worked out when
/// it is first asked for, and again after a change of the cells that it looked at.
///
/// Paths go diagonally first, then straight. A jump point is a cell with a blocked cell at one of its corners and both
/// cells between open: where a shortest path may turn out of a straight run.
class JumpGraph {
 public:
  using NodeId = std::uint32_t;
  static constexpr NodeId kNone = ~NodeId{0};
  /// Directions (0 to 7) in which a path may go on; straight ones stay straight.
  using Parts = std::uint8_t;
  static constexpr Parts kAllParts = 0xFF;

  struct Edge {
    NodeId target = kNone;
    Spot at;           ///< of the target
    Parts onward = 0;  ///< from the target, having come this way
  };
  /// What is in sight of a spot: how far each diagonal goes, and a rectangle around these and all that was found.
  struct View {
    std::array<std::uint16_t, 4> diagonal{};
    Spot low, high;
  };

  /// Takes the grid as it is now. It must outlive this and change only along with `update`.
  explicit JumpGraph(const OpenGrid& grid);

  /// Cells in `window` have changed. Costs the words of the rows and columns that the window touches, and a
  /// comparison for every jump point of the map.
  void update(const Window& window);
  /// Works out all that is not known yet; without this the queries do, as they come by.
  void complete();

  [[nodiscard]] const OpenGrid& grid() const { return grid_; }
  [[nodiscard]] std::size_t size() const { return nodes_.size(); }
  [[nodiscard]] Spot at(NodeId node) const { return nodes_[node].at; }

  /// Calls `take(Edge)` for every edge in one of `parts`. @pre the node is alive: an id that an edge gave since
  /// the last update.
  template <class Take>
  void for_each_edge(NodeId id, Parts parts, Take take) {
    Node& node = nodes_[id];
    if (!node.is_listed) list(node);
    const Edge* edges = edges_.data() + node.first;
    for (unsigned rest = parts & node.parts; rest != 0; rest &= rest - 1) {
      const int part = std::countr_zero(rest);
      for (std::uint32_t i = node.begin[part]; i < node.begin[part + 1]; ++i) take(edges[i]);
    }
  }
  [[nodiscard]] const View& view(NodeId id) {
    Node& node = nodes_[id];
    if (!node.is_listed) list(node);
    return node.view;
  }

  /// Appends what an open cell leads to straight on in `direction`, and adds to its view.
  void scan_straight(Spot from, int direction, std::vector<Edge>& edges, View& view) const;
  /// Walks up to `steps` steps along a diagonal (4 to 7), which are open as far as `at` moves, and appends what its
  /// cells lead to straight on. Returns whether the diagonal may go on.
  bool scan_diagonal(Spot& at, int part, int steps, std::vector<Edge>& edges, View& view) const;

  /// How many steps a diagonal (4 to 7) goes on from a cell, at most `most`.
  [[nodiscard]] int diagonal_run(Spot from, int part, int most) const;
  /// Whether `to` is seen from `from` diagonally first, then straight.
  [[nodiscard]] bool is_direct(Spot from, Spot to) const;
  /// The same, given how far diagonals go from there.
  [[nodiscard]] bool is_direct(Spot from, const View& view, Spot to) const;

 private:
  struct Node {
    Spot at;
    std::array<Parts, 4> onward{};  ///< by the direction in which a path comes
    Parts parts = 0;                ///< all of these
    bool is_listed = false;
    View view;
    std::uint32_t first = 0;
    std::array<std::uint32_t, 9> begin{};
  };
  struct Box {
    int x0, y0, x1, y1;
    [[nodiscard]] bool meets(const View& view) const {
      return view.low.x <= x1 && view.high.x >= x0 && view.low.y <= y1 && view.high.y >= y0;
    }
  };
  static constexpr int kTile = 64;
  using Ids = std::array<NodeId, kTile * kTile>;

  [[nodiscard]] std::array<Parts, 4> onward_at(Spot at) const;
  [[nodiscard]] NodeId& id_at(Spot at) const;
  void find_stops(int axis, int line, int first_word, int last_word);
  void find_leads(int axis, int line);
  void find_squares(int line, int first_word, int last_word);
  void widen(int axis, int line, int first, int last, int& low, int& high) const;
  void settle(Spot at);
  void list(Node& node);
  void scan(Node& node, int part);
  void compact();

  const OpenGrid& grid_;
  std::array<BitLines, 4> stops_;  ///< by direction: a run ends here, at a blocked cell or a jump point
  std::array<BitLines, 4> leads_;  ///< by direction: the run from here ends at a jump point
  BitLines squares_;               ///< this cell and the three above, to the right and between are open
  std::vector<Node> nodes_;
  std::vector<NodeId> unused_;
  int tiles_per_row_;
  std::vector<std::unique_ptr<Ids>> ids_;  ///< by tiles, where there are jump points
  std::vector<Edge> edges_;
  std::size_t garbage_ = 0;  ///< edges that no node owns any more
};

}  // namespace concord

#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "planner/search/jump_graph.hpp"
#include "planner/search/octile.hpp"
#include "planner/search/open_list.hpp"

namespace concord {

/// A shortest path over open cells in eight directions.
struct OctilePath {
  std::int64_t cost = 0;      ///< in kStraight and kDiagonal
  std::vector<Cell> turns;    ///< from start to goal; between two, steps in one direction
  std::int64_t expanded = 0;  ///< jump points
};

/// The fast path: A* over a jump graph. Exact; ties go to the point nearer to the goal, then to the one that was
/// found first. Keeps what one query needs, and forgets it at the next by counting queries.
class JumpSearch {
 public:
  explicit JumpSearch(JumpGraph& graph) : graph_(graph) {}

  /// Nothing where there is no way, and where either end is blocked or beyond the grid.
  [[nodiscard]] std::optional<OctilePath> find(Cell start, Cell goal);

 private:
  using NodeId = JumpGraph::NodeId;
  struct State {
    std::int64_t cost = 0;
    std::uint32_t query = 0;  ///< in which it was reached; else it is not
    NodeId parent = JumpGraph::kNone;
    JumpGraph::Parts pending = 0, done = 0;
  };

  void begin();
  void push_part(int part);
  void scan_part(int part);
  void reach(const JumpGraph::Edge& edge, Spot from, std::int64_t cost, NodeId parent);
  [[nodiscard]] OctilePath trace(NodeId last, std::int64_t cost);

  JumpGraph& graph_;
  std::vector<State> states_;
  std::uint32_t query_ = 0;
  OpenList open_;
  std::int64_t least_ = 0;  ///< cost if nothing stood in the way
  Spot start_, goal_;
  std::int64_t expanded_ = 0;
  std::array<Spot, 8> scanned_;         ///< how far the start was left in each direction
  std::vector<JumpGraph::Edge> first_;  ///< from the start
  std::vector<Spot> spots_;             ///< of the path, backwards
};

}  // namespace concord

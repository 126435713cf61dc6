#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "planner/se2/sampled_search.hpp"
#include "planner/search/grid_paths.hpp"

namespace concord {

/// What a search for a way between two poses may take, in steps: so the same request is answered in the same way.
struct PoseEffort {
  std::int64_t guided = 20'000;    ///< along the grid path, at each density
  std::int64_t corridor = 4'000;   ///< samples around it
  std::int64_t anywhere = 20'000;  ///< samples wherever the grid leads
  std::int64_t shortening = 4'000;
  std::int64_t cells = 4'000'000;  ///< of the grid path, and as many of all ways round places too narrow for it
  /// Asked again and again. Once it says yes there is no result: for whoever withdrew the request, or watches the
  /// clock.
  std::function<bool()> stop = [] { return false; };
};

enum class PoseOutcome {
  kFound,
  kStartBlocked,  ///< the footprint overlaps something there
  kGoalBlocked,
  kNoWay,    ///< proved: not even the largest disc in the footprint gets there
  kGaveUp,   ///< the effort was spent
  kStopped,  ///< `stop` said so
};

/// A path is given as poses on its arcs, and whoever measures it by the chords between them must not find it to turn
/// tighter than was asked for: arcs are so much wider.
inline constexpr double kChordRadius = 1.0005;

/// How a way was found.
enum class PoseMeans { kNone, kGuided, kCorridor, kAnywhere };

struct PoseRoute {
  PoseOutcome outcome = PoseOutcome::kGaveUp;
  PoseMeans means = PoseMeans::kNone;
  /// From the start to the goal, in cells. Between two it goes along an arc, a line, or turns in place: evenly in yaw,
  /// with its reference point within kBow of the straight line.
  std::vector<Pose> poses;
  double length = 0;       ///< of the reference point's way, cells
  std::int64_t steps = 0;  ///< of all searches
};

/// Ways for a robot with a footprint that steers as a car or turns in place, on a grid that changes. Looks along a grid
/// path first, then by samples around it, then by samples anywhere; what it finds is shortened and checked again.
/// Unlike on cells, that it finds nothing does not prove that there is nothing, but where the grid alone does.
class PoseSearch {
 public:
  /// Works out what depends on the grid alone. Footprint and turn radius (0: turns in place) in cells. `grid` must
  /// outlive this and change only along with `update`; so must `extra`, what it costs besides to be in a cell (null:
  /// nothing), which is not heeded where only samples find a way.
  PoseSearch(const OpenGrid& grid, const Footprint& footprint, double turn_radius, const ExtraCosts* extra = nullptr);
  PoseSearch(const PoseSearch&) = delete;
  PoseSearch& operator=(const PoseSearch&) = delete;

  /// Cells in `window` have changed, or what it costs to be in them.
  void update(const Window& window);

  /// Any input is answered. Poses in cells.
  [[nodiscard]] PoseRoute find(const Pose& start, const Pose& goal, const PoseEffort& effort = {});

  [[nodiscard]] const StandingRoom& room() const { return room_; }

 private:
  /// Of `window`, which must lie on the grid: whether the footprint's inner disc may be anywhere in a cell.
  void open_cells(OpenGrid& to, const Window& window) const;
  void take_extra(const Window& window);
  /// Cells that keep away from walls, past places that the footprint does not fit into where there is a way round.
  [[nodiscard]] std::optional<std::vector<Cell>> grid_path(Cell start, Cell goal, const PoseEffort& effort);
  [[nodiscard]] SampleRegion anywhere(Cell from);
  [[nodiscard]] FoundMotions search(const std::vector<Cell>& cells, const Pose& start, const Pose& goal,
                                    const PoseEffort& effort, PoseRoute& route);

  const OpenGrid& grid_;
  const ExtraCosts* extra_;
  DistanceField field_;
  StandingRoom room_;
  MotionCost cost_;
  Steering steering_;
  std::unique_ptr<GridPaths> ways_;
};

}  // namespace concord

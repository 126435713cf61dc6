#pragma once

#include <cstdint>
#include <limits>
#include <optional>

#include "planner/search/grid_paths.hpp"

namespace concord {

/// A path that keeps away from walls, kept up while the grid changes. A change that leaves it open and costs it no more
/// than a share is no reason for another path: paths do not flip to and fro. Else the stretch that the change spoilt is
/// found anew between what is left of it on either side, and all of it where that costs too much. What opened elsewhere
/// endangers nobody: whether it saves more than the share is looked for when there is time.
class KeptPath {
 public:
  /// So much costlier than what was, or than what could be, a path is kept.
  static constexpr double kShare = 0.1;

  enum class Outcome {
    kKept,
    kRepaired,     ///< a stretch of it is another
    kAnew,         ///< found from scratch
    kUnreachable,  ///< there is no way any more
  };

  static constexpr std::int64_t kNoLimit = std::numeric_limits<std::int64_t>::max();

  /// `paths` must outlive this. A search from scratch looks at so many cells before it takes the fast path.
  explicit KeptPath(GridPaths& paths, std::int64_t most_expanded = kNoLimit)
      : paths_(&paths), most_expanded_(most_expanded) {}

  /// The same cells are now in `paths`, by `shift` from where they were.
  void move_to(GridPaths& paths, Cell shift);
  /// The path begins at its cell `first` from now on. @pre there is a path, and that cell of it.
  void begin_at(std::size_t first);

  /// From scratch.
  Outcome plan(Cell start, Cell goal);
  /// Cells in `window` have changed, and `paths` has been updated; `opened` is what that returned. Where there was no
  /// way it looks again if any was opened.
  Outcome follow(const Window& window, bool opened);
  /// Looks for a path that costs less than this one by more than the share, if any cell that was opened since can make
  /// one. Takes as long as a search from scratch at most. Returns whether it took one.
  bool improve();
  /// Whether `improve` would look.
  [[nodiscard]] bool may_improve() const { return path_ && may_improve_; }
  [[nodiscard]] const std::optional<ClearPath>& path() const { return path_; }

 private:
  /// Positions in the path's cells: the part within reach of a window.
  struct Stretch {
    std::size_t first, last;
  };

  [[nodiscard]] std::optional<Stretch> near(const Window& window) const;
  [[nodiscard]] bool is_open(const Window& window) const;
  [[nodiscard]] bool could_save(const Window& window) const;
  [[nodiscard]] bool repair(const Stretch& stretch);
  Outcome take(std::optional<ClearPath> found);

  GridPaths* paths_;
  std::int64_t most_expanded_;
  Cell start_, goal_;
  std::optional<ClearPath> path_;
  std::int64_t cost_ = 0;      ///< of the path that was last found from scratch, then
  std::int64_t expanded_ = 0;  ///< by the last search from scratch
  bool may_improve_ = false;
};

}  // namespace concord

#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>

#include "bus/messages.hpp"
#include "bus/process.hpp"
#include "planner/grid.hpp"

namespace concord {

/// Asks merge which edit pinned what cut a way off: the last active one whose voxels lie around the place.
class BlamedEditsNode {
 public:
  struct Blamed {
    std::string robot;
    std::int64_t path_id;
    std::string edit, author;
  };

  explicit BlamedEditsNode(const NodeContext& context) : context_(context) {}

  /// A path to this robot is cut off at `p` (map frame, metres) by an edit within the band.
  void ask(const std::string& robot, std::int64_t path_id, const Eigen::Vector2d& p, const Band& band);
  /// A part of an answer; what it was asked for is blamed when all parts are there.
  [[nodiscard]] std::optional<Blamed> take(const HistoryPart& part);

 private:
  static constexpr std::size_t kMaxAsked = 64;
  struct Asked {
    Blamed blamed;
    VoxelIndex low, high;          ///< where the edit must reach to
    std::set<std::int32_t> heard;  ///< parts
    std::int64_t revision = 0;
  };

  NodeContext context_;
  std::map<std::string, Asked> asked_;  ///< by request
  std::int64_t count_ = 0;
};

}  // namespace concord

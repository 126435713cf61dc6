#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "bus/process.hpp"
#include "bus/recent_answers.hpp"
#include "bus/replies.hpp"
#include "core/correction_check.hpp"
#include "core/map_archive.hpp"
#include "merge/agents_node.hpp"
#include "merge/map_store.hpp"
#include "merge/map_streams.hpp"
#include "merge/merge_store.hpp"
#include "merge/people.hpp"
#include "merge/people_node.hpp"

namespace concord {

/// Saves, lists and loads maps. Of a map that is loaded merge takes what people corrected; its layers are ingest's.
class MapsNode {
 public:
  /// All of them must outlive this.
  struct Parts {
    MergeStore& store;
    const People& people;
    MapStreams& map;
    const AgentsNode& agents;
    PeopleNode& people_node;
  };
  MapsNode(const NodeContext& context, const Parts& parts);
  MapsNode(const MapsNode&) = delete;
  MapsNode& operator=(const MapsNode&) = delete;

 private:
  void save(const MapRequest& request);
  void list(const MapRequest& request);
  void load(const MapRequest& request);

  [[nodiscard]] Result<std::optional<Bytes>> labels_for(const MapRequest& request) const;
  [[nodiscard]] Result<MapStore::Files> write(const MapRequest& request, const Bytes& labels);
  [[nodiscard]] Result<void> may_write(const MapRequest& request);
  [[nodiscard]] Result<Bytes> encoded(const std::string& format, const Bytes& labels);
  [[nodiscard]] Result<Bytes> archived(const Bytes& labels);

  /// A native file that is being loaded, between its request and the arrival of its layers: it is read once.
  struct Opened {
    std::string request_id;
    std::uint64_t content = 0;  ///< of the request
    MapStore::Version version;
    MapArchive archive;  ///< without bricks
    std::int64_t incarnation = 0;
    std::int64_t asked = 0;          ///< last, microseconds
    std::int64_t fits_at = -1;       ///< our revision that its corrections were last found to follow on
    CorrectionCheck ours;            ///< has taken our corrections
    std::int64_t ours_revision = 0;  ///< up to this one
    std::optional<Answer> labels;    ///< semantic's last word on them
  };
  /// Whether the file may be loaded, then whether its layers are there, then what people corrected.
  void advance(const MapRequest& request, std::uint64_t content);
  [[nodiscard]] Result<void> open(const MapRequest& request, std::uint64_t content);
  void take_over(const MapRequest& request, const std::vector<Correction>& corrections, std::uint64_t content);
  [[nodiscard]] Result<std::vector<Correction>> following();
  [[nodiscard]] Result<void> take_ours();
  [[nodiscard]] bool has_layers() const;
  [[nodiscard]] Result<void> labels_may_load() const;
  void say_may_load(const MapRequest& request);

  static inline const std::string kRequests = "in/map_request";
  static inline const std::string kNative = "concord";
  /// It says its status each second: longer, microseconds, and it is busy, or does not run.
  static constexpr std::int64_t kSemanticSilence = 3'500'000;

  NodeContext context_;
  Parts parts_;
  Replies replies_;
  MapStore maps_;
  RecentAnswers answers_;
  std::int64_t start_;
  std::optional<std::int64_t> semantic_heard_;  ///< when, last
  std::optional<Opened> opened_;
};

}  // namespace concord

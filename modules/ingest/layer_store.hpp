#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "ingest/ingest.hpp"
#include "store/database.hpp"

namespace concord {

/// The layers on disk (one SQLite file), so that they outlive their senders and this process. What agents send is
/// noted and written by the next flush(), changed bricks only; what people ask for is written at once by replace().
class LayerStore {
 public:
  struct Loaded {
    std::vector<std::pair<std::string, Agent>> agents;
    std::vector<std::string> removed;                    ///< see `removed` below, oldest first
    std::vector<std::pair<std::string, Error>> refused;  ///< agent, why a part of it could not be read
  };
  /// How many removed agents are remembered, so that who was not listening can still be told.
  static constexpr int kMaxRemoved = 64;

  /// @throws std::runtime_error if the file cannot be used, or holds layers of another resolution (metres).
  LayerStore(const std::filesystem::path& file, double resolution);

  /// Everything that was written. A brick whose bytes are damaged is left out and told; the rest stands.
  [[nodiscard]] Result<Loaded> load();

  /// The agent changed in memory; flush() will write it.
  void note(const std::string& id, const Change& change);
  void note(const std::string& id, BrickIndex index);
  [[nodiscard]] bool is_flushed() const { return pending_.empty(); }

  /// Writes all that was noted in one transaction. On failure nothing is written and all stays noted.
  [[nodiscard]] Result<void> flush(const std::map<std::string, Agent>& agents);

  /// Makes the agent on disk be this; null: it is gone, and remembered as removed. On failure nothing changed.
  [[nodiscard]] Result<void> replace(const std::string& id, const Agent* agent);

 private:
  struct Pending {
    bool all = false;  ///< the layer began anew: what stands on disk is void
    std::set<BrickIndex> bricks;
  };

  void check_resolution(double resolution);
  [[nodiscard]] Result<std::int64_t> write_row(const std::string& id, const Agent& agent);
  [[nodiscard]] Result<void> write_brick(std::int64_t key, BrickIndex index, const Brick* brick);
  [[nodiscard]] Result<void> write_pending(const std::string& id, const Agent& agent, const Pending& pending);
  [[nodiscard]] Result<void> write_all(const std::string& id, const Agent& agent);
  [[nodiscard]] Result<void> write_removed(const std::string& id);
  [[nodiscard]] Result<void> load_content(std::int64_t key, const std::string& id, Agent& agent);

  Database database_;
  Statement upsert_agent_, select_agents_, delete_agent_;
  Statement insert_dead_frame_, select_dead_frames_, delete_dead_frames_;
  Statement upsert_brick_, select_bricks_, delete_brick_, delete_bricks_;
  Statement insert_removed_, select_removed_, delete_removed_, trim_removed_;
  std::map<std::string, Pending> pending_;
  Bytes bytes_;  ///< of the brick being written
};

}  // namespace concord

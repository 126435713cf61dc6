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
/// noted and written later in slices, changed bricks only; what people ask for is written at once by replace().
///
/// A layer that begins anew, or is replaced by more than one slice holds, is written beside the one that stands. That
/// one is what a start finds until the last brick of the new one is written; so a layer on disk is never half of one
/// frame or octomap and half of another.
class LayerStore {
 public:
  struct Loaded {
    std::vector<std::pair<std::string, Agent>> agents;
    std::vector<std::string> removed;                    ///< see `removed` below, oldest first
    std::vector<std::pair<std::string, Error>> refused;  ///< agent, why a part of it could not be read
  };
  /// How many removed agents are remembered, so that who was not listening can still be told.
  static constexpr int kMaxRemoved = 64;
  /// Bricks of one agent in one transaction: some 20 ms.
  static constexpr std::size_t kSlice = 2000;

  /// @throws std::runtime_error if the file cannot be used, or holds layers of another resolution (metres).
  LayerStore(const std::filesystem::path& file, double resolution);

  /// Everything that was written. A brick whose bytes are damaged is left out and told; the rest stands.
  [[nodiscard]] Result<Loaded> load();

  /// Writes at once who a new agent is, its layer still empty: people may place it from the first moment, and a restart
  /// must not take it for another. Does nothing for an agent that is on disk.
  [[nodiscard]] Result<void> introduce(const std::string& id, const Agent& agent);

  /// The agent changed in memory; it will be written.
  void note(const std::string& id, const Agent& agent, const Change& change);
  void note(const std::string& id, BrickIndex index);
  /// Agents whose changes are not all on disk.
  [[nodiscard]] std::size_t to_write() const { return pending_.size(); }
  /// Nothing is to be written, and nothing that is void is still there.
  [[nodiscard]] bool is_idle() const { return pending_.empty() && void_layers_.empty(); }

  /// Writes about a slice of what was noted, in one transaction, and drops bricks that are void. On failure nothing is
  /// written and all stays noted.
  [[nodiscard]] Result<void> write_some(const std::map<std::string, Agent>& agents);
  /// Writes all that was noted.
  [[nodiscard]] Result<void> flush(const std::map<std::string, Agent>& agents);

  /// Makes the agent on disk be this; null: it is gone, and remembered as removed. On failure nothing changed.
  [[nodiscard]] Result<void> replace(const std::string& id, const Agent* agent);
  /// Writes new agents: all of them or, when it fails or is killed in their midst, none.
  [[nodiscard]] Result<void> add(const std::vector<std::pair<std::string, Agent>>& agents);

 private:
  struct Pending {
    /// Of the layer that is written beside the one that stands; 0: the one that stands is written.
    std::int64_t beside = 0;
    std::set<BrickIndex> bricks;  ///< changed and not written yet
  };
  /// What a transaction wrote: no longer pending once it is committed.
  struct Slice {
    std::string id;
    std::set<BrickIndex>::const_iterator end;  ///< bricks before this one
    bool complete;
  };

  void check_resolution(double resolution);
  void find_layers();
  [[nodiscard]] Result<std::size_t> write_slices(const std::map<std::string, Agent>& agents,
                                                 std::vector<Slice>& slices);
  [[nodiscard]] Result<Slice> write_slice(const std::string& id, const Agent& agent, const Pending& pending);
  [[nodiscard]] Result<void> write_row(const std::string& id, const Agent& agent, std::int64_t layer);
  [[nodiscard]] Result<void> write_brick(std::int64_t layer, BrickIndex index, const Brick* brick);
  [[nodiscard]] Result<void> write_all(const std::string& id, const Agent& agent, std::int64_t layer);
  [[nodiscard]] Result<void> write_removed(const std::string& id);
  [[nodiscard]] Result<bool> drop_void(std::size_t most);
  void stands_now(const std::string& id, std::int64_t layer);
  [[nodiscard]] Result<void> load_content(const std::string& id, Agent& agent);

  Database database_;
  Statement upsert_agent_, select_agents_, delete_agent_;
  Statement insert_dead_frame_, select_dead_frames_, delete_dead_frames_;
  Statement upsert_brick_, select_bricks_, delete_brick_, delete_some_bricks_, any_brick_;
  Statement insert_removed_, select_removed_, delete_removed_, trim_removed_;
  std::map<std::string, std::int64_t> layers_;  ///< the one that stands on disk, by agent
  std::vector<std::int64_t> void_layers_;       ///< their bricks are still on disk, and belong to nobody
  std::int64_t last_layer_ = 0;
  std::map<std::string, Pending> pending_;
  std::string served_;  ///< agents are written in turns: the last one that was
  Bytes bytes_;         ///< of the brick being written
};

}  // namespace concord

#include "ingest/layer_store.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <utility>

#include "core/brick_codec.hpp"
#include "core/decimal.hpp"
#include "core/requests.hpp"

namespace concord {
namespace {

constexpr std::array<const char*, 1> kMigrations = {R"(
CREATE TABLE lattice (
  resolution REAL NOT NULL        -- metres, of all layers
) STRICT;
CREATE TABLE agent (
  id TEXT PRIMARY KEY,
  layer INTEGER NOT NULL UNIQUE,  -- of its bricks; others of the same agent are half written or void
  incarnation INTEGER NOT NULL,
  frame_id TEXT NOT NULL,
  source INTEGER NOT NULL,        -- Source in ingest.hpp
  boot_id INTEGER NOT NULL,       -- of its clouds, as the next
  next_sequence INTEGER NOT NULL
) STRICT, WITHOUT ROWID;
CREATE TABLE dead_frame (
  agent TEXT NOT NULL REFERENCES agent (id) ON DELETE CASCADE,
  position INTEGER NOT NULL,      -- the latest has the highest
  frame_id TEXT NOT NULL,
  PRIMARY KEY (agent, position)
) STRICT, WITHOUT ROWID;
CREATE TABLE brick (
  layer INTEGER NOT NULL,
  x INTEGER NOT NULL, y INTEGER NOT NULL, z INTEGER NOT NULL,
  voxels BLOB NOT NULL,           -- core/brick_codec.hpp
  PRIMARY KEY (layer, x, y, z)
) STRICT, WITHOUT ROWID;
CREATE TABLE removed (
  position INTEGER PRIMARY KEY AUTOINCREMENT,
  id TEXT NOT NULL UNIQUE
) STRICT;
)"};

Error damaged(const std::string& id, const std::string& what) {
  return {Code::kMalformed, "layer of " + id + " on disk: " + what + "; send it again, or remove the agent"};
}

std::optional<BrickIndex> checked_index(std::int64_t x, std::int64_t y, std::int64_t z) {
  const auto fits = [](std::int64_t c) { return c >= -kMaxVoxel && c <= kMaxVoxel; };
  if (!fits(x) || !fits(y) || !fits(z)) return std::nullopt;
  const BrickIndex index{static_cast<std::int32_t>(x), static_cast<std::int32_t>(y), static_cast<std::int32_t>(z)};
  return in_bounds(index) ? std::optional(index) : std::nullopt;
}

}  // namespace

LayerStore::LayerStore(const std::filesystem::path& file, double resolution)
    : database_(file, kMigrations),
      upsert_agent_(database_.prepare(
          "INSERT INTO agent VALUES (?, ?, ?, ?, ?, ?, ?) ON CONFLICT (id) DO UPDATE SET layer = excluded.layer, "
          "incarnation = excluded.incarnation, frame_id = excluded.frame_id, source = excluded.source, boot_id = "
          "excluded.boot_id, "
          "next_sequence = excluded.next_sequence")),
      select_agents_(
          database_.prepare("SELECT id, frame_id, source, boot_id, next_sequence, incarnation FROM agent ORDER BY id")),
      delete_agent_(database_.prepare("DELETE FROM agent WHERE id = ?")),
      insert_dead_frame_(database_.prepare("INSERT INTO dead_frame VALUES (?, ?, ?)")),
      select_dead_frames_(database_.prepare("SELECT frame_id FROM dead_frame WHERE agent = ? ORDER BY position")),
      delete_dead_frames_(database_.prepare("DELETE FROM dead_frame WHERE agent = ?")),
      upsert_brick_(database_.prepare("INSERT OR REPLACE INTO brick VALUES (?, ?, ?, ?, ?)")),
      select_bricks_(database_.prepare("SELECT x, y, z, voxels FROM brick WHERE layer = ?")),
      delete_brick_(database_.prepare("DELETE FROM brick WHERE layer = ? AND x = ? AND y = ? AND z = ?")),
      delete_some_bricks_(database_.prepare("DELETE FROM brick WHERE (layer, x, y, z) IN "
                                            "(SELECT layer, x, y, z FROM brick WHERE layer = ? LIMIT ?)")),
      any_brick_(database_.prepare("SELECT 1 FROM brick WHERE layer = ? LIMIT 1")),
      insert_removed_(database_.prepare("INSERT OR REPLACE INTO removed (id) VALUES (?)")),
      select_removed_(database_.prepare("SELECT id FROM removed ORDER BY position")),
      delete_removed_(database_.prepare("DELETE FROM removed WHERE id = ?")),
      trim_removed_(database_.prepare("DELETE FROM removed WHERE position NOT IN "
                                      "(SELECT position FROM removed ORDER BY position DESC LIMIT ?)")) {
  check_resolution(resolution);
  find_layers();
}

void LayerStore::check_resolution(double resolution) {
  std::optional<double> written;
  Statement select = database_.prepare("SELECT resolution FROM lattice");
  auto done = select.for_each_row([&] { written = select.real(0); });
  if (done && !written) done = database_.prepare("INSERT INTO lattice VALUES (?)").run(resolution);
  if (!done) throw std::runtime_error(done.error().message);
  if (!written || *written == resolution) return;
  throw std::runtime_error("the layers on disk have a resolution of " + decimal(*written) + " m, the site " +
                           decimal(resolution) + " m; set it back, or move ingest.db away and send all again");
}

/// What stands, and what a kill left of layers that were half written or half dropped.
void LayerStore::find_layers() {
  Statement standing = database_.prepare("SELECT id, layer FROM agent");
  Statement left = database_.prepare("SELECT DISTINCT layer FROM brick WHERE layer NOT IN (SELECT layer FROM agent)");
  auto done = standing.for_each_row([&] { layers_[standing.text(0)] = standing.integer(1); });
  if (done) done = left.for_each_row([&] { void_layers_.push_back(left.integer(0)); });
  if (!done) throw std::runtime_error(done.error().message);
  for (const auto& [id, layer] : layers_) last_layer_ = std::max(last_layer_, layer);
  for (const std::int64_t layer : void_layers_) last_layer_ = std::max(last_layer_, layer);
}

void LayerStore::note(const std::string& id, const Agent& agent, const Change& change) {
  Pending& pending = pending_[id];
  // A cloud only adds: bricks with and without it may stand side by side.
  const bool replaces =
      agent.source != Source::kClouds && pending.beside == 0 && pending.bricks.size() + change.bricks.size() > kSlice;
  if (!change.new_frame && !replaces) {
    pending.bricks.insert(change.bricks.begin(), change.bricks.end());
    return;
  }
  if (pending.beside != 0) void_layers_.push_back(pending.beside);
  pending.beside = ++last_layer_;
  const std::vector<BrickIndex> all = agent.layer.sorted_bricks();
  pending.bricks = {all.begin(), all.end()};
}

Result<void> LayerStore::introduce(const std::string& id, const Agent& agent) {
  if (layers_.contains(id)) return {};
  auto transaction = Transaction::begin(database_);
  if (!transaction) return tl::unexpected(transaction.error());
  const std::int64_t layer = ++last_layer_;
  if (auto done = write_row(id, agent, layer); !done) return done;
  if (auto done = transaction->commit(); !done) return done;
  layers_[id] = layer;
  return {};
}

void LayerStore::note(const std::string& id, BrickIndex index) { pending_[id].bricks.insert(index); }

Result<void> LayerStore::flush(const std::map<std::string, Agent>& agents) {
  while (!pending_.empty()) {
    if (auto done = write_some(agents); !done) return done;
  }
  return {};
}

Result<void> LayerStore::write_some(const std::map<std::string, Agent>& agents) {
  if (is_idle()) return {};
  auto transaction = Transaction::begin(database_);
  if (!transaction) return tl::unexpected(transaction.error());
  std::vector<Slice> slices;
  const auto written = write_slices(agents, slices);
  if (!written) return tl::unexpected(written.error());
  const auto dropped = drop_void(kSlice - std::min(kSlice, *written));
  if (!dropped) return tl::unexpected(dropped.error());
  if (auto done = transaction->commit(); !done) return done;

  if (*dropped) void_layers_.pop_back();
  for (const Slice& slice : slices) {
    Pending& pending = pending_.at(slice.id);
    pending.bricks.erase(pending.bricks.begin(), slice.end);
    served_ = slice.id;
    if (!slice.complete) continue;
    if (pending.beside != 0) stands_now(slice.id, pending.beside);
    pending_.erase(slice.id);
  }
  return {};
}

/// Returns the number of bricks written.
Result<std::size_t> LayerStore::write_slices(const std::map<std::string, Agent>& agents, std::vector<Slice>& slices) {
  std::size_t written = 0;
  auto next = pending_.upper_bound(served_);
  for (std::size_t i = 0; i < pending_.size() && written < kSlice; ++i, ++next) {
    if (next == pending_.end()) next = pending_.begin();
    auto& [id, pending] = *next;
    auto slice = write_slice(id, agents.at(id), pending);
    if (!slice) return tl::unexpected(slice.error());
    written += static_cast<std::size_t>(std::distance(pending.bricks.begin(), slice->end));
    slices.push_back(std::move(*slice));
  }
  return written;
}

Result<LayerStore::Slice> LayerStore::write_slice(const std::string& id, const Agent& agent, const Pending& pending) {
  const std::int64_t layer = pending.beside != 0 ? pending.beside : layers_.at(id);
  auto next = pending.bricks.begin();
  for (std::size_t i = 0; i < kSlice && next != pending.bricks.end(); ++i, ++next) {
    if (auto done = write_brick(layer, *next, agent.layer.find(*next)); !done) return tl::unexpected(done.error());
  }
  const bool complete = next == pending.bricks.end();
  if (complete || pending.beside == 0) {
    if (auto done = write_row(id, agent, layer); !done) return tl::unexpected(done.error());
  }
  return Slice{id, next, complete};
}

/// Whether the last of the void layers is gone by this.
Result<bool> LayerStore::drop_void(std::size_t most) {
  if (void_layers_.empty() || most == 0) return false;
  if (auto done = delete_some_bricks_.run(void_layers_.back(), most); !done) return tl::unexpected(done.error());
  const auto more = any_brick_.bind(void_layers_.back()).step();
  any_brick_.reset();
  if (!more) return tl::unexpected(more.error());
  return !*more;
}

void LayerStore::stands_now(const std::string& id, std::int64_t layer) {
  const auto [it, is_new] = layers_.try_emplace(id, layer);
  if (!is_new && it->second != layer) void_layers_.push_back(std::exchange(it->second, layer));
}

Result<void> LayerStore::replace(const std::string& id, const Agent* agent) {
  auto transaction = Transaction::begin(database_);
  if (!transaction) return tl::unexpected(transaction.error());
  const std::int64_t layer = ++last_layer_;
  if (auto done = agent != nullptr ? write_all(id, *agent, layer) : write_removed(id); !done) return done;
  if (auto done = transaction->commit(); !done) return done;

  const auto pending = pending_.find(id);
  if (pending != pending_.end()) {
    if (pending->second.beside != 0) void_layers_.push_back(pending->second.beside);
    pending_.erase(pending);
  }
  stands_now(id, layer);
  if (agent == nullptr) layers_.erase(id);
  return {};
}

Result<void> LayerStore::add(const std::vector<std::pair<std::string, Agent>>& agents) {
  auto transaction = Transaction::begin(database_);
  if (!transaction) return tl::unexpected(transaction.error());
  std::int64_t layer = last_layer_;
  for (const auto& [id, agent] : agents) {
    if (auto done = write_all(id, agent, ++layer); !done) return done;
  }
  if (auto done = transaction->commit(); !done) return done;
  for (const auto& [id, agent] : agents) stands_now(id, ++last_layer_);
  return {};
}

Result<void> LayerStore::write_all(const std::string& id, const Agent& agent, std::int64_t layer) {
  if (auto done = write_row(id, agent, layer); !done) return done;
  if (auto done = delete_dead_frames_.run(id); !done) return done;
  for (std::size_t i = 0; i < agent.dead_frames.size(); ++i) {
    if (auto done = insert_dead_frame_.run(id, i, agent.dead_frames[i]); !done) return done;
  }
  // In the order of the table: it grows at its end instead of everywhere.
  for (const BrickIndex index : agent.layer.sorted_bricks()) {
    if (auto done = write_brick(layer, index, agent.layer.find(index)); !done) return done;
  }
  return {};
}

Result<void> LayerStore::write_removed(const std::string& id) {
  if (auto done = delete_agent_.run(id); !done) return done;
  if (auto done = insert_removed_.run(id); !done) return done;
  return trim_removed_.run(kMaxRemoved);
}

Result<void> LayerStore::write_row(const std::string& id, const Agent& agent, std::int64_t layer) {
  if (auto done = delete_removed_.run(id); !done) return done;
  const auto& [boot_id, sequence] = agent.next_cloud;
  return upsert_agent_.run(id, layer, agent.incarnation, agent.frame_id, static_cast<int>(agent.source), boot_id,
                           sequence);
}

Result<void> LayerStore::write_brick(std::int64_t layer, BrickIndex index, const Brick* brick) {
  if (brick == nullptr) return delete_brick_.run(layer, index.x, index.y, index.z);
  bytes_.clear();
  append_brick(bytes_, *brick);
  return upsert_brick_.run(layer, index.x, index.y, index.z, bytes_);
}

Result<LayerStore::Loaded> LayerStore::load() {
  Loaded loaded;
  auto read = select_agents_.bind().for_each_row([&] {
    std::string id = select_agents_.text(0);
    Agent agent;
    agent.frame_id = select_agents_.text(1);
    const std::int64_t source = select_agents_.integer(2);
    agent.next_cloud = {select_agents_.integer(3), select_agents_.integer(4)};
    agent.incarnation = select_agents_.integer(5);
    if (!is_name(id) || !is_name(agent.frame_id) || source < 0 || source > static_cast<int>(Source::kFile)) {
      loaded.refused.emplace_back(id, damaged(id, "its row is damaged"));
      return;
    }
    agent.source = static_cast<Source>(source);
    loaded.agents.emplace_back(std::move(id), std::move(agent));
  });
  if (!read) return tl::unexpected(read.error());
  for (auto& [id, agent] : loaded.agents) {
    if (auto done = load_content(id, agent); !done) loaded.refused.emplace_back(id, done.error());
  }
  read = select_removed_.bind().for_each_row([&] { loaded.removed.push_back(select_removed_.text(0)); });
  if (!read) return tl::unexpected(read.error());
  return loaded;
}

Result<void> LayerStore::load_content(const std::string& id, Agent& agent) {
  auto read =
      select_dead_frames_.bind(id).for_each_row([&] { agent.dead_frames.push_back(select_dead_frames_.text(0)); });
  if (!read) return read;
  std::int64_t bad = 0;
  read = select_bricks_.bind(layers_.at(id)).for_each_row([&] {
    ByteSpan bytes = select_bricks_.bytes(3);
    auto brick = read_brick(bytes);
    const auto index = checked_index(select_bricks_.integer(0), select_bricks_.integer(1), select_bricks_.integer(2));
    if (!brick || brick->empty() || !bytes.empty() || !index) {
      ++bad;
      return;
    }
    agent.layer.set(*index, std::move(*brick));
  });
  if (read && bad > 0) return tl::unexpected(damaged(id, std::to_string(bad) + " bricks are damaged and left out"));
  return read;
}

}  // namespace concord

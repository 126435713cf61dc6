#include "ingest/layer_store.hpp"

#include <array>
#include <optional>
#include <stdexcept>

#include "core/brick_codec.hpp"
#include "core/requests.hpp"

namespace concord {
namespace {

constexpr std::array<const char*, 1> kMigrations = {R"(
CREATE TABLE lattice (
  resolution REAL NOT NULL        -- metres, of all layers
) STRICT;
CREATE TABLE agent (
  key INTEGER PRIMARY KEY,
  id TEXT NOT NULL UNIQUE,
  frame_id TEXT NOT NULL,
  source INTEGER NOT NULL,        -- Source in ingest.hpp
  next_sequence INTEGER NOT NULL
) STRICT;
CREATE TABLE dead_frame (
  agent INTEGER NOT NULL REFERENCES agent (key) ON DELETE CASCADE,
  position INTEGER NOT NULL,      -- the latest has the highest
  frame_id TEXT NOT NULL,
  PRIMARY KEY (agent, position)
) STRICT, WITHOUT ROWID;
CREATE TABLE brick (
  agent INTEGER NOT NULL REFERENCES agent (key) ON DELETE CASCADE,
  x INTEGER NOT NULL, y INTEGER NOT NULL, z INTEGER NOT NULL,
  voxels BLOB NOT NULL,           -- core/brick_codec.hpp
  PRIMARY KEY (agent, x, y, z)
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
          "INSERT INTO agent (id, frame_id, source, next_sequence) VALUES (?, ?, ?, ?) ON CONFLICT (id) DO UPDATE SET "
          "frame_id = excluded.frame_id, source = excluded.source, next_sequence = excluded.next_sequence "
          "RETURNING key")),
      select_agents_(database_.prepare("SELECT key, id, frame_id, source, next_sequence FROM agent ORDER BY id")),
      delete_agent_(database_.prepare("DELETE FROM agent WHERE id = ?")),
      insert_dead_frame_(database_.prepare("INSERT INTO dead_frame VALUES (?, ?, ?)")),
      select_dead_frames_(database_.prepare("SELECT frame_id FROM dead_frame WHERE agent = ? ORDER BY position")),
      delete_dead_frames_(database_.prepare("DELETE FROM dead_frame WHERE agent = ?")),
      upsert_brick_(database_.prepare("INSERT OR REPLACE INTO brick VALUES (?, ?, ?, ?, ?)")),
      select_bricks_(database_.prepare("SELECT x, y, z, voxels FROM brick WHERE agent = ?")),
      delete_brick_(database_.prepare("DELETE FROM brick WHERE agent = ? AND x = ? AND y = ? AND z = ?")),
      delete_bricks_(database_.prepare("DELETE FROM brick WHERE agent = ?")),
      insert_removed_(database_.prepare("INSERT OR REPLACE INTO removed (id) VALUES (?)")),
      select_removed_(database_.prepare("SELECT id FROM removed ORDER BY position")),
      delete_removed_(database_.prepare("DELETE FROM removed WHERE id = ?")),
      trim_removed_(database_.prepare("DELETE FROM removed WHERE position NOT IN "
                                      "(SELECT position FROM removed ORDER BY position DESC LIMIT ?)")) {
  check_resolution(resolution);
}

void LayerStore::check_resolution(double resolution) {
  std::optional<double> written;
  Statement select = database_.prepare("SELECT resolution FROM lattice");
  auto done = select.for_each_row([&] { written = select.real(0); });
  if (done && !written) done = database_.prepare("INSERT INTO lattice VALUES (?)").run(resolution);
  if (!done) throw std::runtime_error(done.error().message);
  if (!written || *written == resolution) return;
  throw std::runtime_error("the layers on disk have a resolution of " + std::to_string(*written) + " m, the site " +
                           std::to_string(resolution) + " m; set it back, or move ingest.db away and send all again");
}

void LayerStore::note(const std::string& id, const Change& change) {
  Pending& pending = pending_[id];
  if (change.new_frame) {
    pending.all = true;
    pending.bricks.clear();
  }
  // When all is to be written the single bricks need no list.
  if (!pending.all) pending.bricks.insert(change.bricks.begin(), change.bricks.end());
}

void LayerStore::note(const std::string& id, BrickIndex index) {
  Pending& pending = pending_[id];
  if (!pending.all) pending.bricks.insert(index);
}

Result<void> LayerStore::flush(const std::map<std::string, Agent>& agents) {
  if (pending_.empty()) return {};
  auto transaction = Transaction::begin(database_);
  if (!transaction) return tl::unexpected(transaction.error());
  for (const auto& [id, pending] : pending_) {
    if (auto done = write_pending(id, agents.at(id), pending); !done) return done;
  }
  if (auto done = transaction->commit(); !done) return done;
  pending_.clear();
  return {};
}

Result<void> LayerStore::replace(const std::string& id, const Agent* agent) {
  auto transaction = Transaction::begin(database_);
  if (!transaction) return tl::unexpected(transaction.error());
  if (auto done = agent != nullptr ? write_all(id, *agent) : write_removed(id); !done) return done;
  if (auto done = transaction->commit(); !done) return done;
  pending_.erase(id);
  return {};
}

Result<void> LayerStore::write_pending(const std::string& id, const Agent& agent, const Pending& pending) {
  if (pending.all) return write_all(id, agent);
  const auto key = write_row(id, agent);
  if (!key) return tl::unexpected(key.error());
  for (const BrickIndex index : pending.bricks) {
    if (auto done = write_brick(*key, index, agent.layer.find(index)); !done) return done;
  }
  return {};
}

Result<void> LayerStore::write_all(const std::string& id, const Agent& agent) {
  const auto key = write_row(id, agent);
  if (!key) return tl::unexpected(key.error());
  if (auto done = delete_bricks_.run(*key); !done) return done;
  if (auto done = delete_dead_frames_.run(*key); !done) return done;
  for (std::size_t i = 0; i < agent.dead_frames.size(); ++i) {
    if (auto done = insert_dead_frame_.run(*key, i, agent.dead_frames[i]); !done) return done;
  }
  // In the order of the table: it grows at its end instead of everywhere.
  for (const BrickIndex index : agent.layer.sorted_bricks()) {
    if (auto done = write_brick(*key, index, agent.layer.find(index)); !done) return done;
  }
  return {};
}

Result<void> LayerStore::write_removed(const std::string& id) {
  if (auto done = delete_agent_.run(id); !done) return done;
  if (auto done = insert_removed_.run(id); !done) return done;
  return trim_removed_.run(kMaxRemoved);
}

Result<std::int64_t> LayerStore::write_row(const std::string& id, const Agent& agent) {
  if (auto done = delete_removed_.run(id); !done) return tl::unexpected(done.error());
  const auto row = upsert_agent_.bind(id, agent.frame_id, static_cast<int>(agent.source), agent.next_sequence).step();
  if (!row) return tl::unexpected(row.error());
  const std::int64_t key = upsert_agent_.integer(0);
  upsert_agent_.reset();
  return key;
}

Result<void> LayerStore::write_brick(std::int64_t key, BrickIndex index, const Brick* brick) {
  if (brick == nullptr) return delete_brick_.run(key, index.x, index.y, index.z);
  bytes_.clear();
  append_brick(bytes_, *brick);
  return upsert_brick_.run(key, index.x, index.y, index.z, bytes_);
}

Result<LayerStore::Loaded> LayerStore::load() {
  Loaded loaded;
  std::vector<std::int64_t> keys;
  auto read = select_agents_.bind().for_each_row([&] {
    std::string id = select_agents_.text(1);
    Agent agent;
    agent.frame_id = select_agents_.text(2);
    const std::int64_t source = select_agents_.integer(3);
    agent.next_sequence = select_agents_.integer(4);
    if (!is_name(id) || !is_name(agent.frame_id) || source < 0 || source > static_cast<int>(Source::kFile)) {
      loaded.refused.emplace_back(id, damaged(id, "its row is damaged"));
      return;
    }
    agent.source = static_cast<Source>(source);
    keys.push_back(select_agents_.integer(0));
    loaded.agents.emplace_back(std::move(id), std::move(agent));
  });
  if (!read) return tl::unexpected(read.error());
  for (std::size_t i = 0; i < keys.size(); ++i) {
    auto& [id, agent] = loaded.agents[i];
    if (auto done = load_content(keys[i], id, agent); !done) loaded.refused.emplace_back(id, done.error());
  }
  read = select_removed_.bind().for_each_row([&] { loaded.removed.push_back(select_removed_.text(0)); });
  if (!read) return tl::unexpected(read.error());
  return loaded;
}

Result<void> LayerStore::load_content(std::int64_t key, const std::string& id, Agent& agent) {
  auto read =
      select_dead_frames_.bind(key).for_each_row([&] { agent.dead_frames.push_back(select_dead_frames_.text(0)); });
  if (!read) return read;
  std::int64_t bad = 0;
  read = select_bricks_.bind(key).for_each_row([&] {
    ByteSpan bytes = select_bricks_.bytes(3);
    auto brick = read_brick(bytes);
    const auto index = checked_index(select_bricks_.integer(0), select_bricks_.integer(1), select_bricks_.integer(2));
    if (!brick || brick->empty() || !bytes.empty() || !index) {
      ++bad;
      return;
    }
    agent.known += brick->known_count();
    agent.layer.set(*index, std::move(*brick));
  });
  if (read && bad > 0) return tl::unexpected(damaged(id, std::to_string(bad) + " bricks are damaged and left out"));
  return read;
}

}  // namespace concord

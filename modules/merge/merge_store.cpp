#include "merge/merge_store.hpp"

#include <array>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "bus/site.hpp"
#include "core/byte_stream.hpp"
#include "core/voxel_boxes.hpp"

namespace concord {
namespace {

constexpr const char* kMigrations[] = {
    "CREATE TABLE site (resolution REAL NOT NULL);"
    "CREATE TABLE transforms (agent TEXT NOT NULL, frame_id TEXT NOT NULL, incarnation INTEGER NOT NULL,"
    "  has_layer INTEGER NOT NULL, author TEXT NOT NULL, utime INTEGER NOT NULL,"
    "  x REAL NOT NULL, y REAL NOT NULL, z REAL NOT NULL,"
    "  qx REAL NOT NULL, qy REAL NOT NULL, qz REAL NOT NULL, qw REAL NOT NULL,"
    "  PRIMARY KEY (agent, frame_id, incarnation));"
    "CREATE TABLE edits (revision INTEGER PRIMARY KEY AUTOINCREMENT, edit_id TEXT NOT NULL UNIQUE, author TEXT NOT "
    "NULL,"
    "  utime INTEGER NOT NULL, op INTEGER NOT NULL, boxes BLOB NOT NULL);",
};

/// Stored for good, so numbered here and not by the enum.
constexpr int kAdd = 1;
constexpr int kDelete = 2;

Bytes to_bytes(std::span<const VoxelBox> boxes) {
  Bytes out;
  for (const VoxelBox& box : boxes) {
    for (const std::int32_t c : {box.min.x, box.min.y, box.min.z, box.max.x, box.max.y, box.max.z}) append_le(out, c);
  }
  return out;
}

Result<std::vector<VoxelIndex>> voxels_of(ByteSpan bytes) {
  std::vector<VoxelBox> boxes;
  while (!bytes.empty()) {
    std::array<std::int32_t, 6> c{};
    for (std::int32_t& value : c) {
      const auto read = read_le<std::int32_t>(bytes);
      if (!read) return refuse(Code::kIo, "an edit in the store ends early; restore merge.db from a backup");
      value = *read;
    }
    boxes.push_back({{c[0], c[1], c[2]}, {c[3], c[4], c[5]}});
  }
  return expand(boxes, std::int64_t{1} << 30);
}

}  // namespace

MergeStore::MergeStore(const std::filesystem::path& file, double resolution)
    : database_(file, kMigrations),
      put_transform_(database_.prepare("INSERT OR REPLACE INTO transforms VALUES (?,?,?,?,?,?,?,?,?,?,?,?,?)")),
      put_edit_(database_.prepare("INSERT INTO edits (edit_id, author, utime, op, boxes) VALUES (?,?,?,?,?)")) {
  check_resolution(resolution);
}

void MergeStore::check_resolution(double resolution) {
  Statement read = database_.prepare("SELECT resolution FROM site");
  const Result<bool> row = read.step();
  if (!row) throw std::runtime_error(row.error().message);
  if (!*row) {
    read.reset();
    const auto written = database_.prepare("INSERT INTO site VALUES (?)").run(resolution);
    if (!written) throw std::runtime_error(written.error().message);
  } else if (std::abs(read.real(0) - resolution) > 1e-9) {
    throw ConfigError("the edits in this state folder are for " + std::to_string(read.real(0)) +
                      " m voxels; set resolution to that, or start with another state folder");
  }
}

Result<void> MergeStore::put_transform(const Placed& placed, const std::string& author, std::int64_t utime) {
  const Eigen::Vector3d p = placed.T_map_agent.translation();
  const Eigen::Quaterniond q(placed.T_map_agent.linear());
  return put_transform_.run(placed.agent, placed.frame_id, placed.incarnation, placed.has_layer, author, utime, p.x(),
                            p.y(), p.z(), q.x(), q.y(), q.z(), q.w());
}

Result<void> MergeStore::put_edit(const EditRequest& edit) {
  const Bytes boxes = to_bytes(to_boxes(edit.voxels));
  const int op = edit.op == EditRequest::Op::kAdd ? kAdd : kDelete;
  return put_edit_.run(edit.id, edit.author, edit.utime, op, std::span<const std::uint8_t>(boxes));
}

Result<std::vector<MergeStore::Placed>> MergeStore::transforms() {
  std::vector<Placed> out;
  std::optional<Error> broken;
  Statement read = database_.prepare(
      "SELECT agent, frame_id, incarnation, has_layer, x, y, z, qx, qy, qz, qw FROM transforms "
      "ORDER BY agent, frame_id, incarnation");
  const auto done = read.for_each_row([&] {
    const auto T = make_transform({read.real(4), read.real(5), read.real(6)},
                                  {read.real(7), read.real(8), read.real(9), read.real(10)});
    if (!T) broken = T.error();
    if (T) out.push_back({read.text(0), read.text(1), read.integer(2), read.integer(3) != 0, *T});
  });
  if (!done) return tl::unexpected(done.error());
  if (broken) return tl::unexpected(*broken);
  return out;
}

Result<void> MergeStore::for_each_edit(const std::function<void(const EditRequest&)>& visit) {
  std::optional<Error> broken;
  Statement read = database_.prepare("SELECT edit_id, author, utime, op, boxes FROM edits ORDER BY revision");
  const auto done = read.for_each_row([&] {
    auto voxels = voxels_of(read.bytes(4));
    if (!voxels) broken = voxels.error();
    if (!voxels) return;
    const auto op = read.integer(3) == kAdd ? EditRequest::Op::kAdd : EditRequest::Op::kDelete;
    visit({read.text(0), read.text(1), op, std::move(*voxels), read.integer(2)});
  });
  if (!done) return done;
  if (broken) return tl::unexpected(*broken);
  return {};
}

}  // namespace concord

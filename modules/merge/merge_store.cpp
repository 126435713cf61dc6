#include "merge/merge_store.hpp"

#include <array>
#include <cmath>
#include <optional>

#include "bus/site.hpp"
#include "core/byte_stream.hpp"
#include "core/correction_check.hpp"
#include "core/voxel_boxes.hpp"
#include "merge/merge_schema.hpp"
#include "merge/number_text.hpp"
#include "store/site_resolution.hpp"

namespace concord {
namespace {

using Kind = Operation::Kind;

/// By its number.
constexpr std::array kZoneKinds{"no_go", "allow_contact", "costly", "corridor"};
static_assert(kZoneKinds.size() == static_cast<std::size_t>(Zone::Kind::kCorridor) + 1);

Bytes to_bytes(const std::vector<VoxelIndex>& voxels) {
  Bytes out;
  for (const VoxelBox& box : to_boxes(voxels)) {
    for (const std::int32_t c : {box.min.x, box.min.y, box.min.z, box.max.x, box.max.y, box.max.z}) append_le(out, c);
  }
  return out;
}

Result<std::vector<VoxelIndex>> voxels_of(ByteSpan bytes) {
  if (bytes.empty()) return std::vector<VoxelIndex>{};
  std::vector<VoxelBox> boxes;
  while (!bytes.empty()) {
    std::array<std::int32_t, 6> c{};
    for (std::int32_t& value : c) {
      const auto read = read_le<std::int32_t>(bytes);
      if (!read) return damaged("an edit ends early");
      value = *read;
    }
    boxes.push_back({{c[0], c[1], c[2]}, {c[3], c[4], c[5]}});
  }
  return expand(boxes, kMaxStoredEditVoxels);
}

}  // namespace

tl::unexpected<Error> damaged(const std::string& what) {
  return refuse(Code::kIo, "merge.db: " + what + "; move the file away and bring back a backup");
}

MergeStore::MergeStore(const std::filesystem::path& file, double resolution)
    : database_(file, kMergeSchema),
      put_correction_(database_.prepare("INSERT INTO corrections VALUES (?,?,?,?,?,?,?)")),
      put_edit_(database_.prepare("INSERT INTO edits VALUES (?,?,?)")),
      put_zone_(database_.prepare("INSERT INTO zones VALUES (?,?,?,?,?,?,?,?,?)")),
      put_placement_(database_.prepare("INSERT INTO placements VALUES (?,?,?,?,?,?,?,?)")),
      put_weight_(database_.prepare("INSERT INTO weights VALUES (?,?)")) {
  const double kept = kept_resolution(database_, resolution);
  if (std::abs(kept - resolution) <= 1e-9) return;
  throw ConfigError("the edits in this state folder are for " + std::to_string(kept) +
                    " m voxels; set resolution to that, or start with another state folder");
}

/// What belongs to a correction beside its row in `corrections`.
struct MergeStore::PutDetail {
  MergeStore& store;
  std::int64_t revision;

  Result<void> operator()(const Correction::Edit& edit) const {
    const Bytes added = to_bytes(edit.added);
    const Bytes deleted = to_bytes(edit.deleted);
    return store.put_edit_.run(revision, ByteSpan(added), ByteSpan(deleted));
  }
  Result<void> operator()(const Correction::Undo&) const { return {}; }
  Result<void> operator()(const Correction::ZoneChange& change) const {
    if (change.op == ZoneRequest::Op::kDelete) return {};
    const Zone& zone = change.zone;
    const Eigen::Vector3d p = zone.T_map_zone.translation();
    return store.put_zone_.run(revision, kZoneKinds[static_cast<std::size_t>(zone.kind)], to_text(zone.volume), p.x(),
                               p.y(), p.z(), to_text(Eigen::Matrix3d(zone.T_map_zone.linear())), zone.margin,
                               std::int64_t{zone.cost});
  }
  Result<void> operator()(const Correction::Placement& placement) const {
    const Eigen::Vector3d p = placement.T_map_agent.translation();
    return store.put_placement_.run(revision, placement.frame_id, placement.incarnation, placement.has_layer, p.x(),
                                    p.y(), p.z(), to_text(Eigen::Matrix3d(placement.T_map_agent.linear())));
  }
  Result<void> operator()(const Correction::Weight& weight) const {
    return store.put_weight_.run(revision, weight.weight);
  }
};

Result<void> MergeStore::put(std::span<const Correction> corrections) {
  auto transaction = Transaction::begin(database_);
  if (!transaction) return tl::unexpected(transaction.error());
  for (const Correction& correction : corrections) {
    if (const auto done = put_one(correction); !done) return done;
  }
  return transaction->commit();
}

Result<void> MergeStore::put_one(const Correction& correction) {
  const Operation row = summary(correction, true);
  const auto done = put_correction_.run(row.revision, row.id, row.author, row.utime, name(row.kind), row.subject,
                                        static_cast<std::int64_t>(correction.content));
  if (!done) return done;
  return std::visit(PutDetail{*this, correction.revision}, correction.what);
}

/// Reads what PutDetail wrote, into a correction that has all else.
struct MergeStore::Readers {
  explicit Readers(Database& database)
      : edit(database.prepare("SELECT added, deleted FROM edits WHERE revision = ?")),
        zone(database.prepare("SELECT x, y, z, rotation, kind, volume, margin, cost FROM zones WHERE revision = ?")),
        placement(database.prepare(
            "SELECT x, y, z, rotation, frame_id, incarnation, has_layer FROM placements WHERE revision = ?")),
        weight(database.prepare("SELECT weight FROM weights WHERE revision = ?")) {}

  Result<void> read(Kind kind, const std::string& subject, Correction& out) {
    switch (kind) {
      case Kind::kAdd: return read_edit(EditRequest::Op::kAdd, out);
      case Kind::kDelete: return read_edit(EditRequest::Op::kDelete, out);
      case Kind::kMove: return read_edit(EditRequest::Op::kMove, out);
      case Kind::kUndo: out.what = Correction::Undo{subject, false}; return {};
      case Kind::kRedo: out.what = Correction::Undo{subject, true}; return {};
      case Kind::kZoneAdd: return read_zone(ZoneRequest::Op::kAdd, subject, out);
      case Kind::kZoneChange: return read_zone(ZoneRequest::Op::kChange, subject, out);
      case Kind::kZoneDelete: {
        Zone gone;
        gone.name = subject;
        out.what = Correction::ZoneChange{ZoneRequest::Op::kDelete, gone};
        return {};
      }
      case Kind::kTransform: return read_placement(subject, out);
      case Kind::kWeight: break;
    }
    return read_weight(subject, out);
  }

  /// The row of this correction.
  static Result<void> fetch(Statement& statement, const Correction& of) {
    const Result<bool> row = statement.bind(of.revision).step();
    if (!row) return tl::unexpected(row.error());
    if (!*row) return damaged("half of revision " + std::to_string(of.revision) + " is missing");
    return {};
  }
  static Result<Transform> transform_in(const Statement& row) {
    const auto rotation = rotation_from_text(row.text(3));
    const Eigen::Vector3d p(row.real(0), row.real(1), row.real(2));
    if (!rotation || !p.allFinite()) return damaged("a transform is none");
    Transform T = Transform::Identity();
    T.linear() = *rotation;
    T.translation() = p;
    return T;
  }

  Result<void> read_edit(EditRequest::Op op, Correction& out) {
    if (const auto row = fetch(edit, out); !row) return row;
    auto added = voxels_of(edit.bytes(0));
    auto deleted = voxels_of(edit.bytes(1));
    if (!added || !deleted) return damaged("the voxels of edit " + out.id + " are none");
    out.what = Correction::Edit{op, std::move(*added), std::move(*deleted)};
    return {};
  }
  Result<void> read_zone(ZoneRequest::Op op, const std::string& name, Correction& out) {
    if (const auto row = fetch(zone, out); !row) return row;
    const auto T = transform_in(zone);
    const auto volume = volume_from_text(zone.text(5));
    const auto* const kind = std::ranges::find(kZoneKinds, zone.text(4));
    if (!T || !volume || kind == kZoneKinds.end()) return damaged("zone " + name + " is none");
    Zone there;
    there.name = name;
    there.kind = static_cast<Zone::Kind>(kind - kZoneKinds.begin());
    there.volume = *volume;
    there.margin = zone.real(6);
    there.cost = static_cast<int>(zone.integer(7));
    if (!check_terms(there.kind, there.margin, there.cost)) return damaged("zone " + name + " has no such terms");
    there.T_map_zone = *T;
    out.what = Correction::ZoneChange{op, there};
    return {};
  }
  Result<void> read_placement(const std::string& agent, Correction& out) {
    if (const auto row = fetch(placement, out); !row) return row;
    const auto T = transform_in(placement);
    if (!T) return tl::unexpected(T.error());
    out.what = Correction::Placement{agent, placement.text(4), placement.integer(5), placement.integer(6) != 0, *T};
    return {};
  }
  Result<void> read_weight(const std::string& agent, Correction& out) {
    if (const auto row = fetch(weight, out); !row) return row;
    const std::int64_t value = weight.integer(0);
    if (value < 1 || value > 1000) return damaged("the weight of " + agent + " is none");
    out.what = Correction::Weight{agent, static_cast<int>(value)};
    return {};
  }

  Statement edit, zone, placement, weight;
};

Result<void> MergeStore::for_each(const std::function<Result<void>(Correction)>& visit, std::int64_t after) {
  Readers readers(database_);
  Statement rows = database_.prepare(
      "SELECT revision, id, author, utime, kind, subject, content FROM corrections WHERE revision > ? ORDER BY "
      "revision");
  rows.bind(after);
  for (;;) {
    const Result<bool> row = rows.step();
    if (!row) return tl::unexpected(row.error());
    if (!*row) return {};
    Correction correction{
        rows.integer(0),   rows.text(1), rows.text(2), rows.integer(3), static_cast<std::uint64_t>(rows.integer(6)),
        Correction::Undo{}};
    const auto kind = operation_called(rows.text(4));
    if (!kind) return damaged("a kind of correction called " + rows.text(4));
    if (const auto read = readers.read(*kind, rows.text(5), correction); !read) return read;
    if (const auto visited = visit(std::move(correction)); !visited) return visited;
  }
}

}  // namespace concord

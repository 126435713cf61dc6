#include "semantic/semantic_store.hpp"

#include <array>
#include <cmath>
#include <stdexcept>

#include "bus/site.hpp"
#include "core/byte_stream.hpp"
#include "core/voxel_boxes.hpp"
#include "semantic/semantic_schema.hpp"

namespace concord {
namespace {

constexpr const char* kLabel = "label";
constexpr const char* kRename = "rename";
constexpr const char* kReassign = "reassign";
constexpr const char* kTakeOff = "take_off";
constexpr const char* kUndo = "undo";
constexpr const char* kRedo = "redo";

tl::unexpected<Error> damaged(const std::string& what) {
  return refuse(Code::kIo, "semantic.db: " + what + "; move the file away and bring back a backup");
}

/// A correction as its row has it.
struct Row {
  std::string kind;
  InstanceId of, to;
  std::string text, edit_id;
  Bytes voxels;
};

Bytes to_bytes(const std::vector<VoxelIndex>& voxels) {
  Bytes out;
  for (const VoxelBox& box : to_boxes(voxels)) {
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
      if (!read) return damaged("a label ends early");
      value = *read;
    }
    boxes.push_back({{c[0], c[1], c[2]}, {c[3], c[4], c[5]}});
  }
  return expand(boxes, kMaxLabelVoxels);
}

struct ToRow {
  Row operator()(const LabelCorrection::Claim& claim) const {
    return {kLabel, claim.of, {}, claim.class_name, claim.edit_id, to_bytes(claim.voxels)};
  }
  Row operator()(const LabelCorrection::Rename& rename) const {
    return {kRename, {rename.label, 0}, {}, rename.name, "", {}};
  }
  Row operator()(const LabelCorrection::Reassign& reassign) const {
    return {kReassign, reassign.from, reassign.to, "", "", {}};
  }
  Row operator()(const LabelCorrection::TakeOff& take_off) const { return {kTakeOff, take_off.of, {}, "", "", {}}; }
  Row operator()(const LabelCorrection::Undo& undo) const {
    return {undo.redo ? kRedo : kUndo, {}, {}, undo.correction_id, "", {}};
  }
};

Result<decltype(LabelCorrection::what)> what_of(const Row& row) {
  if (row.kind == kLabel) {
    auto voxels = voxels_of(row.voxels);
    if (!voxels) return damaged("the voxels of a label are none");
    return LabelCorrection::Claim{row.of, row.text, std::move(*voxels), row.edit_id};
  }
  if (row.kind == kRename) return LabelCorrection::Rename{row.of.label, row.text};
  if (row.kind == kReassign) return LabelCorrection::Reassign{row.of, row.to};
  if (row.kind == kTakeOff) return LabelCorrection::TakeOff{row.of};
  if (row.kind == kUndo || row.kind == kRedo) return LabelCorrection::Undo{row.text, row.kind == kRedo};
  return damaged("a kind of correction called " + row.kind);
}

}  // namespace

SemanticStore::SemanticStore(const std::filesystem::path& file, double resolution)
    : database_(file, kSemanticSchema),
      put_(database_.prepare("INSERT INTO corrections VALUES (?,?,?,?,?,?,?,?,?,?,?,?,?)")) {
  check_resolution(resolution);
}

void SemanticStore::check_resolution(double resolution) {
  Statement read = database_.prepare("SELECT resolution FROM site");
  const Result<bool> row = read.step();
  if (!row) throw std::runtime_error(row.error().message);
  if (!*row) {
    read.reset();
    const auto written = database_.prepare("INSERT INTO site VALUES (?)").run(resolution);
    if (!written) throw std::runtime_error(written.error().message);
  } else if (std::abs(read.real(0) - resolution) > 1e-9) {
    throw ConfigError("the labels in this state folder are for " + std::to_string(read.real(0)) +
                      " m voxels; set resolution to that, or start with another state folder");
  }
}

Result<void> SemanticStore::put(const LabelCorrection& correction) {
  const Row row = std::visit(ToRow{}, correction.what);
  return put_.run(correction.revision, correction.id, correction.author, correction.utime,
                  static_cast<std::int64_t>(correction.content), row.kind, row.of.label, row.of.instance, row.to.label,
                  row.to.instance, row.text, row.edit_id, ByteSpan(row.voxels));
}

Result<void> SemanticStore::for_each(const std::function<Result<void>(LabelCorrection)>& visit) {
  Statement rows = database_.prepare("SELECT * FROM corrections ORDER BY revision");
  for (;;) {
    const Result<bool> more = rows.step();
    if (!more) return tl::unexpected(more.error());
    if (!*more) return {};
    const auto number = [&](int column) { return static_cast<std::uint32_t>(rows.integer(column)); };
    const auto voxels = rows.bytes(12);
    const Row row{rows.text(5),  {number(6), number(7)}, {number(8), number(9)},
                  rows.text(10), rows.text(11),          {voxels.begin(), voxels.end()}};
    auto what = what_of(row);
    if (!what) return tl::unexpected(what.error());
    const auto visited = visit({rows.integer(0), rows.text(1), rows.text(2), rows.integer(3),
                                static_cast<std::uint64_t>(rows.integer(4)), std::move(*what)});
    if (!visited) return visited;
  }
}

}  // namespace concord

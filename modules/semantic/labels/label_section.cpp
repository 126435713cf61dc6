#include "semantic/labels/label_section.hpp"

#include "core/map_archive_fields.hpp"
#include "semantic/labels/labels.hpp"

namespace concord {
namespace {

using archive::append_text;
using archive::FieldReader;

// Numbered here and not by the variant: what was written once stays readable.
enum class What : std::uint8_t { kClaim = 1, kRename, kReassign, kTakeOff, kUndo };

void append(Bytes& out, What what) { append_le(out, static_cast<std::uint8_t>(what)); }
void append(Bytes& out, InstanceId of) {
  append_le(out, of.label);
  append_le(out, of.instance);
}
void append(Bytes& out, const LabelAnchor& anchor) {
  append_le(out, static_cast<std::uint8_t>(anchor.agent.empty() ? 0 : 1));
  if (anchor.agent.empty()) return;
  append_text(out, anchor.agent);
  append_text(out, anchor.frame_id);
  archive::append_transform(out, anchor.T_map_agent);
}

void append(Bytes& out, const Injection& injection) {
  append_text(out, injection.asset);
  archive::append_transform(out, injection.T_map_asset);
  append_text(out, injection.replaces);
}

struct AppendWhat {
  Bytes& out;

  void operator()(const LabelCorrection::Claim& claim) const {
    append(out, What::kClaim);
    append(out, claim.of);
    append_text(out, claim.class_name);
    append_text(out, claim.edit_id);
    if (!claim.edit_id.empty()) append(out, claim.injection);
    append(out, claim.anchor);
    archive::append_voxels(out, claim.voxels);
  }
  void operator()(const LabelCorrection::Rename& rename) const {
    append(out, What::kRename);
    append_le(out, rename.label);
    append_text(out, rename.name);
  }
  void operator()(const LabelCorrection::Reassign& reassign) const {
    append(out, What::kReassign);
    append(out, reassign.from);
    append(out, reassign.to);
  }
  void operator()(const LabelCorrection::TakeOff& take_off) const {
    append(out, What::kTakeOff);
    append(out, take_off.of);
  }
  void operator()(const LabelCorrection::Undo& undo) const {
    append(out, What::kUndo);
    append_text(out, undo.correction_id);
    append_le(out, static_cast<std::uint8_t>(undo.redo ? 1 : 0));
  }
};

InstanceId read_instance(FieldReader& in) {
  InstanceId of;
  of.label = in.integer<std::uint32_t>();
  of.instance = in.integer<std::uint32_t>();
  return of;
}

LabelAnchor read_anchor(FieldReader& in) {
  LabelAnchor anchor;
  if (!in.flag()) return anchor;
  anchor.agent = in.text();
  anchor.frame_id = in.text();
  anchor.T_map_agent = archive::read_transform(in);
  if (anchor.agent.empty()) in.fail();
  return anchor;
}

Injection read_injection(FieldReader& in) {
  Injection injection;
  injection.asset = in.text();
  injection.T_map_asset = archive::read_transform(in);
  injection.replaces = in.text();
  return injection;
}

Result<Labels::What> read_claim(FieldReader& in, std::int64_t most) {
  LabelCorrection::Claim claim;
  claim.of = read_instance(in);
  claim.class_name = in.text();
  claim.edit_id = in.text();
  if (!claim.edit_id.empty()) claim.injection = read_injection(in);
  claim.anchor = read_anchor(in);
  auto voxels = archive::read_voxels(in, static_cast<std::uint64_t>(most));
  if (!voxels) return tl::unexpected(voxels.error());
  claim.voxels = std::move(*voxels);
  return claim;
}

Result<Labels::What> read_what(FieldReader& in, std::int64_t most) {
  switch (static_cast<What>(in.integer<std::uint8_t>())) {
    case What::kClaim: return read_claim(in, most);
    case What::kRename: {
      LabelCorrection::Rename rename;
      rename.label = in.integer<std::uint32_t>();
      rename.name = in.text();
      return rename;
    }
    case What::kReassign: {
      LabelCorrection::Reassign reassign;
      reassign.from = read_instance(in);
      reassign.to = read_instance(in);
      return reassign;
    }
    case What::kTakeOff: return LabelCorrection::TakeOff{read_instance(in)};
    case What::kUndo: {
      LabelCorrection::Undo undo;
      undo.correction_id = in.text();
      undo.redo = in.flag();
      return undo;
    }
  }
  in.fail();
  return LabelCorrection::Undo{};
}

}  // namespace

void append_label_correction(Bytes& out, const LabelCorrection& correction) {
  append_le(out, correction.revision);
  append_text(out, correction.id);
  append_text(out, correction.author);
  append_le(out, correction.utime);
  append_le(out, correction.content);
  std::visit(AppendWhat{out}, correction.what);
}

Result<LabelCorrection> read_label_correction(ByteSpan& bytes, std::int64_t most) {
  FieldReader in(bytes);
  const auto revision = in.integer<std::int64_t>();
  std::string id = in.text();
  std::string author = in.text();
  const auto utime = in.integer<std::int64_t>();
  const auto content = in.integer<std::uint64_t>();
  auto what = read_what(in, most);
  if (!what) return tl::unexpected(what.error());
  if (!in.ok()) return refuse(Code::kMalformed, "a label correction is cut short or none");
  bytes = in.rest();
  return LabelCorrection{revision, std::move(id), std::move(author), utime, content, std::move(*what)};
}

Result<std::vector<LabelCorrection>> read_label_section(ByteSpan section) {
  std::vector<LabelCorrection> out;
  Labels labels(1.0);  // of any resolution: what may follow on what does not hang on where it lies
  BrickSet touched;
  while (!section.empty()) {
    if (out.size() == kMaxReadCorrections) {
      return refuse(Code::kTooLarge, "over " + std::to_string(kMaxReadCorrections) + " label corrections in one file");
    }
    auto next = read_label_correction(section);
    if (!next) return tl::unexpected(next.error());
    if (const auto fine = labels.follows(*next); !fine) {
      return refuse(fine.error().code,
                    "label correction " + std::to_string(next->revision) + ": " + fine.error().message);
    }
    labels.apply(*next, touched);
    touched.clear();
    out.push_back(std::move(*next));
  }
  return out;
}

}  // namespace concord

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <utility>

#include "core/correction_check.hpp"
#include "core/map_archive_fields.hpp"
#include "core/map_archive_parts.hpp"

namespace concord::archive {
namespace {

// Numbered here and not by the enums: what was written once stays readable.
enum class What : std::uint8_t { kEdit = 1, kUndo, kZone, kPlacement, kWeight, kZoneOnTerms };
enum class Form : std::uint8_t { kBox = 1, kOrientedBox, kPrism };

constexpr std::array kEditOps{EditRequest::Op::kAdd, EditRequest::Op::kDelete, EditRequest::Op::kMove};
constexpr std::array kZoneOps{ZoneRequest::Op::kAdd, ZoneRequest::Op::kChange, ZoneRequest::Op::kDelete};
constexpr std::array kZoneKinds{Zone::Kind::kNoGo, Zone::Kind::kAllowContact};
constexpr std::array kZoneKindsOnTerms{Zone::Kind::kNoGo, Zone::Kind::kAllowContact, Zone::Kind::kCostly,
                                       Zone::Kind::kCorridor};

/// An enum as its place in a list, from 1.
template <class Enum, std::size_t size>
void append_one_of(Bytes& out, const std::array<Enum, size>& all, Enum value) {
  append_le(out, static_cast<std::uint8_t>(1 + (std::find(all.begin(), all.end(), value) - all.begin())));
}

template <class Enum, std::size_t size>
Enum read_one_of(FieldReader& in, const std::array<Enum, size>& all) {
  const auto place = in.integer<std::uint8_t>();
  if (place >= 1 && place <= size) return all[place - 1];
  in.fail();
  return all[0];
}

void append_form(Bytes& out, Form form) { append_le(out, static_cast<std::uint8_t>(form)); }

struct AppendVolume {
  Bytes& out;

  void operator()(const Box& box) const {
    append_form(out, Form::kBox);
    append_vector<3>(out, box.min);
    append_vector<3>(out, box.max);
  }
  void operator()(const OrientedBox& box) const {
    append_form(out, Form::kOrientedBox);
    append_transform(out, box.T_frame_box);
    append_vector<3>(out, box.size);
  }
  void operator()(const Prism& prism) const {
    append_form(out, Form::kPrism);
    append_le(out, static_cast<std::uint8_t>(prism.points.size()));
    for (const Eigen::Vector2d& p : prism.points) append_vector<2>(out, p);
    append_real(out, prism.low);
    append_real(out, prism.high);
  }
};
static_assert(kMaxVolumePoints < 256);

Volume read_volume(FieldReader& in) {
  switch (static_cast<Form>(in.integer<std::uint8_t>())) {
    case Form::kBox: {
      Box box;
      box.min = read_vector<3>(in);
      box.max = read_vector<3>(in);
      return box;
    }
    case Form::kOrientedBox: {
      OrientedBox box;
      box.T_frame_box = read_transform(in);
      box.size = read_vector<3>(in);
      return box;
    }
    case Form::kPrism: {
      Prism prism;
      prism.points.resize(in.integer<std::uint8_t>());
      for (Eigen::Vector2d& p : prism.points) p = read_vector<2>(in);
      prism.low = in.real();
      prism.high = in.real();
      return prism;
    }
  }
  in.fail();
  return Box{};
}

void append_what(Bytes& out, What what) { append_le(out, static_cast<std::uint8_t>(what)); }

/// What files of old have no room for; they, and those who read them, know two kinds of zones and nothing more of one.
bool has_terms(const Zone& zone) {
  const bool is_old = std::find(kZoneKinds.begin(), kZoneKinds.end(), zone.kind) != kZoneKinds.end();
  return !is_old || zone.margin != 0 || zone.cost != 0;
}

struct AppendWhat {
  Bytes& out;

  void operator()(const Correction::Edit& edit) const {
    append_what(out, What::kEdit);
    append_one_of(out, kEditOps, edit.op);
    append_voxels(out, edit.added);
    append_voxels(out, edit.deleted);
  }
  void operator()(const Correction::Undo& undo) const {
    append_what(out, What::kUndo);
    append_text(out, undo.edit_id);
    append_le(out, static_cast<std::uint8_t>(undo.redo));
  }
  void operator()(const Correction::ZoneChange& change) const {
    const bool on_terms = has_terms(change.zone);
    append_what(out, on_terms ? What::kZoneOnTerms : What::kZone);
    append_one_of(out, kZoneOps, change.op);
    append_text(out, change.zone.name);
    if (change.op == ZoneRequest::Op::kDelete) return;
    append_one_of(out, kZoneKindsOnTerms, change.zone.kind);
    if (on_terms) {
      append_real(out, change.zone.margin);
      append_le(out, static_cast<std::uint8_t>(change.zone.cost));
    }
    std::visit(AppendVolume{out}, change.zone.volume);
    append_transform(out, change.zone.T_map_zone);
  }
  void operator()(const Correction::Placement& placement) const {
    append_what(out, What::kPlacement);
    append_text(out, placement.agent);
    append_text(out, placement.frame_id);
    append_le(out, placement.incarnation);
    append_le(out, static_cast<std::uint8_t>(placement.has_layer));
    append_transform(out, placement.T_map_agent);
  }
  void operator()(const Correction::Weight& weight) const {
    append_what(out, What::kWeight);
    append_text(out, weight.agent);
    append_le(out, static_cast<std::uint16_t>(weight.weight));
  }
};

Result<Correction::Edit> read_edit(FieldReader& in, const Room& room) {
  const std::uint64_t most = std::min<std::uint64_t>(kMaxStoredEditVoxels, room.pins);
  Correction::Edit edit;
  edit.op = read_one_of(in, kEditOps);
  for (auto* voxels : {&edit.added, &edit.deleted}) {
    auto read = read_voxels(in, most);
    if (!read) return tl::unexpected(read.error());
    *voxels = std::move(*read);
  }
  return edit;
}

Correction::Undo read_undo(FieldReader& in) {
  Correction::Undo undo;
  undo.edit_id = in.text();
  undo.redo = in.flag();
  return undo;
}

/// But for its author, time and revision.
Correction::ZoneChange read_zone_change(FieldReader& in, bool on_terms) {
  Correction::ZoneChange change;
  change.op = read_one_of(in, kZoneOps);
  change.zone.name = in.text();
  if (change.op == ZoneRequest::Op::kDelete) return change;
  change.zone.kind = on_terms ? read_one_of(in, kZoneKindsOnTerms) : read_one_of(in, kZoneKinds);
  if (on_terms) {
    change.zone.margin = in.real();
    change.zone.cost = in.integer<std::uint8_t>();
  }
  change.zone.volume = read_volume(in);
  change.zone.T_map_zone = read_transform(in);
  return change;
}

Correction::Placement read_placement(FieldReader& in) {
  Correction::Placement placement;
  placement.agent = in.text();
  placement.frame_id = in.text();
  placement.incarnation = in.integer<std::int64_t>();
  placement.has_layer = in.flag();
  placement.T_map_agent = read_transform(in);
  return placement;
}

Correction::Weight read_weight(FieldReader& in) {
  Correction::Weight weight;
  weight.agent = in.text();
  weight.weight = in.integer<std::uint16_t>();
  return weight;
}

Result<decltype(Correction::what)> read_what(FieldReader& in, const Room& room) {
  switch (static_cast<What>(in.integer<std::uint8_t>())) {
    case What::kEdit: {
      auto edit = read_edit(in, room);
      if (!edit) return tl::unexpected(edit.error());
      return std::move(*edit);
    }
    case What::kUndo: return read_undo(in);
    case What::kZone: return read_zone_change(in, false);
    case What::kZoneOnTerms: return read_zone_change(in, true);
    case What::kPlacement: return read_placement(in);
    case What::kWeight: return read_weight(in);
  }
  in.fail();
  return Correction::Undo{};
}

}  // namespace

void append_correction(Bytes& out, const Correction& correction) {
  append_le(out, correction.revision);
  append_text(out, correction.id);
  append_text(out, correction.author);
  append_le(out, correction.utime);
  append_le(out, correction.content);
  std::visit(AppendWhat{out}, correction.what);
}

Result<Correction> read_correction(FieldReader& in, Room& room) {
  const auto revision = in.integer<std::int64_t>();
  std::string id = in.text();
  std::string author = in.text();
  const auto utime = in.integer<std::int64_t>();
  const auto content = in.integer<std::uint64_t>();
  auto what = read_what(in, room);
  if (!what) return tl::unexpected(what.error());
  if (!in.ok()) return malformed("a correction is cut short or of an unknown kind; save it again");
  if (auto* change = std::get_if<Correction::ZoneChange>(&*what)) {
    change->zone.author = author;
    change->zone.utime = utime;
    change->zone.revision = revision;
  }
  Correction correction{revision, std::move(id), std::move(author), utime, content, std::move(*what)};
  if (auto fits = room.take_correction(correction); !fits) return tl::unexpected(fits.error());
  return correction;
}

}  // namespace concord::archive

#include <concord/edit_t.hpp>
#include <concord/operation_t.hpp>
#include <concord/zone_request_t.hpp>

#include <limits>

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include "message_checks.hpp"

namespace concord::test {
namespace {

const Box kBox{{0, 0, 0}, {1, 1, 1}};

EditRequest an_edit(Shape shape = kBox) {
  EditRequest edit;
  edit.id = "e";
  edit.shape = std::move(shape);
  return edit;
}

ZoneRequest a_zone() {
  ZoneRequest zone;
  zone.id = "z";
  zone.name = "dock";
  zone.volume = kBox;
  return zone;
}

Prism round(std::size_t corners) {
  Prism prism{{}, 0, 1};
  for (std::size_t i = 0; i < corners; ++i) {
    const double angle = 6.283185307179586 * static_cast<double>(i) / static_cast<double>(corners);
    prism.points.emplace_back(std::cos(angle), std::sin(angle));
  }
  return prism;
}

/// The message as a program could write it that does not heed what our values cannot hold.
template <class Lcm, class Value, class Change>
Bytes tampered(const Value& value, Change change) {
  const Bytes bytes = [&] {
    if constexpr (requires { encode(value); }) {
      return encode(value);
    } else {
      return encode(value, 1);
    }
  }();
  Lcm message;
  EXPECT_EQ(message.decode(bytes.data(), 0, static_cast<int>(bytes.size())), static_cast<int>(bytes.size()));
  change(message);
  Bytes out(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(out.data(), 0, static_cast<int>(out.size()));
  return out;
}

rc::Gen<double> metres() {
  return rc::gen::map(rc::gen::inRange(-100'000, 100'000), [](int mm) { return mm * 1e-3; });
}
rc::Gen<Eigen::Vector3d> point() {
  return rc::gen::apply([](double x, double y, double z) { return Eigen::Vector3d(x, y, z); }, metres(), metres(),
                        metres());
}
Volume any_volume() {
  const Eigen::Vector3d a = *point(), b = *point();
  switch (*rc::gen::inRange(0, 3)) {
    case 0: return Box{a.cwiseMin(b), a.cwiseMax(b)};
    case 1: {
      OrientedBox box{Transform::Identity(), b.cwiseAbs()};
      box.T_frame_box.translation() = a;
      return box;
    }
    default: {
      Prism prism = round(*rc::gen::inRange<std::size_t>(3, kMaxVolumePoints + 1));
      prism.low = std::min(a.z(), b.z());
      prism.high = std::max(a.z(), b.z());
      return prism;
    }
  }
}
Shape any_shape() {
  const double thickness = std::abs(*metres());
  switch (*rc::gen::inRange(0, 4)) {
    case 0: {
      VoxelList list{0.05, {}};
      const int boxes = *rc::gen::inRange(1, 30);
      for (int i = 0; i < boxes; ++i) {
        const auto at = [] { return *rc::gen::inRange(-100, 100); };
        const VoxelIndex v{at(), at(), at()};
        list.boxes.push_back({v, {v.x + i, v.y, v.z + 1}});
      }
      return list;
    }
    case 1: return Line{{*point(), *point(), *point()}, thickness};
    case 2: return Area{{{0, 0, 0}, {1 + thickness, 0, 0}, {0, 1, 0}}, thickness};
    default: return std::visit([](auto volume) { return Shape(std::move(volume)); }, any_volume());
  }
}
WorkFrame any_frame() {
  if (*rc::gen::arbitrary<bool>()) return {};
  return {"headset", *rc::gen::element<std::string>("", "h-1")};
}
std::int64_t any_revision() { return *rc::gen::inRange<std::int64_t>(-1, 1'000'000); }

/// Rotations are not quite the same after a trip through a quaternion; all else is.
template <class T>
void comes_back(const T& value) {
  const Bytes bytes = encode(value);
  const auto read = decode<T>(bytes);
  if (!read) RC_FAIL(read.error().error.message);
  RC_ASSERT(encode(*read) == bytes);
}

RC_GTEST_PROP(MessagesCorrectionProperty, any_edit_comes_back, ()) {
  EditRequest edit = an_edit(any_shape());
  edit.op = *rc::gen::element(EditRequest::Op::kAdd, EditRequest::Op::kDelete, EditRequest::Op::kMove);
  if (edit.op == EditRequest::Op::kMove) edit.move = *point();
  edit.frame = any_frame();
  edit.base_revision = any_revision();
  comes_back(edit);
}

RC_GTEST_PROP(MessagesCorrectionProperty, any_zone_request_comes_back, ()) {
  ZoneRequest zone = a_zone();
  zone.op = *rc::gen::element(ZoneRequest::Op::kAdd, ZoneRequest::Op::kChange);
  zone.kind = *rc::gen::element(Zone::Kind::kNoGo, Zone::Kind::kAllowContact);
  zone.volume = any_volume();
  zone.frame = any_frame();
  zone.base_revision = any_revision();
  comes_back(zone);
}

RC_GTEST_PROP(MessagesCorrectionProperty, any_lease_request_comes_back, ()) {
  const auto utime = *rc::gen::inRange<std::int64_t>(0, std::int64_t{1} << 62);
  comes_back(LeaseRequest{"l", "me", "lease", true, any_volume(), any_frame(), utime});
}

RC_GTEST_PROP(MessagesCorrectionProperty, any_history_comes_back_from_its_parts, ()) {
  HistoryPart whole{"h", 0, 1, {}};
  const int operations = *rc::gen::inRange(0, 200);
  for (int i = 0; i < operations; ++i) {
    const auto kind = static_cast<Operation::Kind>(*rc::gen::inRange(0, 10));
    const auto subject = std::string(*rc::gen::inRange<std::size_t>(0, 80), 's');
    whole.operations.push_back({i + 1, "id", "me", 5, kind, subject, i, i % 2 == 0, {-i, 0, 0}, {0, i, 0}});
  }
  const std::vector<HistoryPart> parts = in_parts(whole);
  std::vector<Operation> back;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const Bytes bytes = encode(parts[i], 1);
    RC_ASSERT(bytes.size() <= 1400U);
    const auto read = decode<HistoryPart>(bytes);
    RC_ASSERT(read.has_value());
    RC_ASSERT(encode(*read, 1) == bytes);
    RC_ASSERT(read->part == static_cast<std::int32_t>(i));
    RC_ASSERT(read->parts == static_cast<std::int32_t>(parts.size()));
    RC_ASSERT(read->operations.empty() == (operations == 0));
    back.insert(back.end(), read->operations.begin(), read->operations.end());
  }
  RC_ASSERT(back.size() == whole.operations.size());
  for (int i = 0; i < operations; ++i) RC_ASSERT(back[i].revision == i + 1);
}

TEST(MessagesCorrection, NeedWhoAsks) {
  EditRequest edit = an_edit();
  edit.author = "line\nbreak";
  expect_refused(decode<EditRequest>(encode(edit)), Code::kBadRequest, "e");
  edit.author.clear();
  EXPECT_TRUE(decode<EditRequest>(encode(edit)));
  edit.id.clear();
  expect_refused(decode<EditRequest>(encode(edit)), Code::kBadRequest, "");
  expect_refused(decode<LeaseRequest>(encode(LeaseRequest{"", "me", "lease", true, kBox, {}, 1})), Code::kBadRequest,
                 "");
  expect_refused(decode<UndoRequest>(encode(UndoRequest{"\x1b", "me", "e", false, 1})), Code::kBadRequest, "");
  expect_refused(decode<HistoryRequest>(encode(HistoryRequest{"", "", "", {}, 0, 0, 0, 1}, 1)), Code::kBadRequest, "");
  expect_refused(decode<ConflictRequest>(encode(ConflictRequest{"", 1}, 1)), Code::kBadRequest, "");
}

TEST(MessagesCorrection, ShapesAreChecked) {
  const auto refused = [](Shape shape) {
    const auto read = decode<EditRequest>(encode(an_edit(std::move(shape))));
    EXPECT_TRUE(read || read.error().id == "e");
    return read ? "OK" : std::string(name(read.error().error.code));
  };
  const Area crossing{{{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}}, 0};
  OrientedBox away{Transform::Identity(), {1, 1, 1}};
  away.T_frame_box.translation().x() = 1e5;
  EXPECT_EQ(refused(kBox), "OK");
  EXPECT_EQ(refused(Box{{0, 0, kNaN}, {1, 1, 1}}), name(Code::kNotFinite));
  EXPECT_EQ(refused(Box{{0, 0, 2}, {1, 1, 1}}), name(Code::kBadShape));
  EXPECT_EQ(refused(Line{{{0, 0, 0}}, 0}), name(Code::kBadShape));
  EXPECT_EQ(refused(Line{{{0, 0, 0}, {1, 0, 0}}, kNaN}), name(Code::kNotFinite));
  EXPECT_EQ(refused(Line{std::vector<Eigen::Vector3d>(1024, Eigen::Vector3d::Zero()), 0}), "OK");
  EXPECT_EQ(refused(crossing), name(Code::kBadShape));
  EXPECT_EQ(refused(away), name(Code::kBadTransform));
  EXPECT_EQ(refused(OrientedBox{Transform::Identity(), {1, -1, 1}}), name(Code::kBadShape));
  EXPECT_EQ(refused(Prism{{{0, 0}, {1, 0}}, 0, 1}), name(Code::kBadShape));
  EXPECT_EQ(refused(Prism{{{0, 0}, {1, 0}, {0, 1}}, 1, 0}), name(Code::kBadShape));
  EXPECT_EQ(refused(Prism{{{0, 0}, {1, 0}, {0, 1}}, kNaN, 1}), name(Code::kNotFinite));
  EXPECT_EQ(refused(VoxelList{0.05, {}}), name(Code::kEmpty));
  EXPECT_EQ(refused(VoxelList{kNaN, {{{0, 0, 0}, {1, 1, 1}}}}), name(Code::kNotFinite));
  EXPECT_EQ(refused(VoxelList{0.05, {{{0, 0, 0}, {0, 0, kMaxVoxel}}}}), name(Code::kOutOfBounds));
  EXPECT_EQ(refused(VoxelList{0.05, {{{1, 0, 0}, {0, 0, 0}}}}), name(Code::kBadShape));
}

TEST(MessagesCorrection, ShapesThatAreTooLongAreRefusedUnread) {
  const Line scribble{std::vector<Eigen::Vector3d>(kMaxShapePoints + 1, Eigen::Vector3d::Zero()), 0};
  expect_refused(decode<EditRequest>(encode(an_edit(scribble))), Code::kTooLarge, "e");
  VoxelList dust{0.05, std::vector<VoxelBox>(65'536)};
  EXPECT_TRUE(decode<EditRequest>(encode(an_edit(dust))));
  dust.boxes.emplace_back();
  expect_refused(decode<EditRequest>(encode(an_edit(dust))), Code::kTooLarge, "e");
}

TEST(MessagesCorrection, ShapesOfNoKindAreRefused) {
  const auto refused = [](auto change) {
    return decode<EditRequest>(tampered<edit_t>(an_edit(), [&](edit_t& edit) { change(edit.shape); }));
  };
  expect_refused(refused([](shape_t& s) { s.kind = 0; }), Code::kBadShape, "e");
  expect_refused(refused([](shape_t& s) { s.kind = 7; }), Code::kBadShape, "e");
  expect_refused(refused([](shape_t& s) { s.kind = shape_t::ORIENTED_BOX; }), Code::kBadShape, "e");
  expect_refused(refused([](shape_t& s) { s.kind = shape_t::VOXELS; }), Code::kBadShape, "e");
  const auto more_corners = [](shape_t& s) {
    s.count = 3;
    for (auto* axis : {&s.x, &s.y, &s.z}) axis->push_back(0);
  };
  expect_refused(refused(more_corners), Code::kBadShape, "e");
  const auto voxels_too = [](shape_t& s) {
    s.boxes = 1;
    for (auto* axis : {&s.min_x, &s.min_y, &s.min_z, &s.max_x, &s.max_y, &s.max_z}) axis->push_back(0);
  };
  expect_refused(refused(voxels_too), Code::kBadShape, "e");
}

TEST(MessagesCorrection, EditsAreChecked) {
  EditRequest edit = an_edit();
  edit.move = {kNaN, 0, 0};
  EXPECT_TRUE(decode<EditRequest>(encode(edit))) << "only a move is moved";
  edit.op = EditRequest::Op::kMove;
  expect_refused(decode<EditRequest>(encode(edit)), Code::kNotFinite, "e");
  edit.move = {0, -1e9, 0};
  expect_refused(decode<EditRequest>(encode(edit)), Code::kOutOfBounds, "e");
  edit.move = {0, 1, 0};
  edit.base_revision = -2;
  expect_refused(decode<EditRequest>(encode(edit)), Code::kBadRequest, "e");
  edit.base_revision = 0;
  EXPECT_TRUE(decode<EditRequest>(encode(edit)));
  edit.frame = {"../x", ""};
  expect_refused(decode<EditRequest>(encode(edit)), Code::kBadName, "e");
  edit.frame = {"headset", "a b"};
  expect_refused(decode<EditRequest>(encode(edit)), Code::kBadFrame, "e");
  edit.frame = {"", "h-1"};
  expect_refused(decode<EditRequest>(encode(edit)), Code::kBadFrame, "e");
  expect_refused(decode<EditRequest>(tampered<edit_t>(an_edit(), [](edit_t& e) { e.op = 4; })), Code::kBadRequest, "e");
  expect_refused(decode<UndoRequest>(encode(UndoRequest{"u", "me", "", false, 1})), Code::kBadRequest, "u");
}

TEST(MessagesCorrection, ZonesAreChecked) {
  ZoneRequest zone = a_zone();
  for (const char* bad : {"", " dock", "dock ", "a/b", "a\\b", "a\nb"}) {
    zone.name = bad;
    expect_refused(decode<ZoneRequest>(encode(zone)), Code::kBadName, "z");
  }
  zone.name = "Förderband 3 (neu)";
  zone.volume = round(kMaxVolumePoints);
  EXPECT_TRUE(decode<ZoneRequest>(encode(zone)));
  zone.volume = round(kMaxVolumePoints + 1);
  expect_refused(decode<ZoneRequest>(encode(zone)), Code::kTooLarge, "z");
  zone.volume = Prism{{{0, 0}, {1, 1}, {1, 0}, {0, 1}}, 0, 1};
  expect_refused(decode<ZoneRequest>(encode(zone)), Code::kBadShape, "z");
  zone.op = ZoneRequest::Op::kDelete;
  EXPECT_TRUE(decode<ZoneRequest>(encode(zone))) << "a volume is not heeded";
  const auto changed = [](auto change) { return decode<ZoneRequest>(tampered<zone_request_t>(a_zone(), change)); };
  expect_refused(changed([](zone_request_t& z) { z.op = 0; }), Code::kBadRequest, "z");
  expect_refused(changed([](zone_request_t& z) { z.kind = 3; }), Code::kBadRequest, "z");
  expect_refused(changed([](zone_request_t& z) { z.volume.kind = shape_t::LINE; }), Code::kBadShape, "z");
  expect_refused(changed([](zone_request_t& z) { z.volume.kind = shape_t::AREA; }), Code::kBadShape, "z");
  const auto emptied = [](zone_request_t& z) {
    z.op = zone_request_t::DELETE;
    z.kind = 0;
    z.volume = shape_t{};
  };
  EXPECT_TRUE(changed(emptied)) << "neither kind nor volume is heeded";
}

TEST(MessagesCorrection, LeasesWeightsAndPlacesAreChecked) {
  expect_refused(decode<LeaseRequest>(encode(LeaseRequest{"l", "me", "lease", true, round(65), {}, 1})),
                 Code::kTooLarge, "l");
  EXPECT_TRUE(decode<LeaseRequest>(encode(LeaseRequest{"l", "me", "lease", false, round(65), {}, 1})));
  for (const int weight : {0, -1, 1001}) {
    expect_refused(decode<WeightRequest>(encode(WeightRequest{"w", "me", "robot1", weight, 1})), Code::kBadRequest,
                   "w");
  }
  expect_refused(decode<WeightRequest>(encode(WeightRequest{"w", "me", "", 1, 1})), Code::kBadName, "w");
  LocaliseRequest place{"p", "me", "robot1", Transform::Identity(), {}, 1};
  EXPECT_TRUE(decode<LocaliseRequest>(encode(place)));
  place.T_frame_base.translation().z() = kNaN;
  expect_refused(decode<LocaliseRequest>(encode(place)), Code::kNotFinite, "p");
  place = {"p", "me", "no agent", Transform::Identity(), {}, 1};
  expect_refused(decode<LocaliseRequest>(encode(place)), Code::kBadName, "p");
}

TEST(MessagesCorrection, QuestionsAreChecked) {
  HistoryRequest history{"h", "", "", {}, 0, 0, 0, 10'000};
  const auto refused = [&](auto change) {
    HistoryRequest changed = history;
    change(changed);
    expect_refused(decode<HistoryRequest>(encode(changed, 1)), Code::kBadRequest, "h");
  };
  EXPECT_TRUE(decode<HistoryRequest>(encode(history, 1)));
  refused([](HistoryRequest& h) { h.most = 0; });
  refused([](HistoryRequest& h) { h.most = 10'001; });
  refused([](HistoryRequest& h) { h.since = -1; });
  refused([](HistoryRequest& h) { h.until = -1; });
  refused([](HistoryRequest& h) { h.after_revision = -1; });
  refused([](HistoryRequest& h) { h.subject = "\x7f"; });
  refused([](HistoryRequest& h) { h.author = "\n"; });
  for (const int most : {0, 1001}) {
    expect_refused(decode<ConflictRequest>(encode(ConflictRequest{"c", most}, 1)), Code::kBadRequest, "c");
  }
}

TEST(MessagesCorrection, AnswersAreChecked) {
  const auto history = [](auto change) {
    HistoryPart part{"h", 0, 1, {{1, "e", "me", 5, Operation::Kind::kAdd, "", 1, true, {1, 1, 1}, {1, 1, 1}}}};
    change(part, part.operations[0]);
    return decode<HistoryPart>(encode(part, 1)).has_value();
  };
  EXPECT_TRUE(history([](HistoryPart&, Operation&) {}));
  EXPECT_FALSE(history([](HistoryPart& p, Operation&) { p.part = 1; }));
  EXPECT_FALSE(history([](HistoryPart& p, Operation&) { p.parts = 10'001; }));
  EXPECT_FALSE(history([](HistoryPart&, Operation& o) { o.revision = -1; }));
  EXPECT_FALSE(history([](HistoryPart&, Operation& o) { o.count = -1; }));
  EXPECT_FALSE(history([](HistoryPart&, Operation& o) { o.min.x = 2; }));
  EXPECT_FALSE(history([](HistoryPart&, Operation& o) { o.max.x = kMaxVoxel; }));
  EXPECT_FALSE(history([](HistoryPart&, Operation& o) { o.subject = "\n"; }));
  EXPECT_FALSE(history([](HistoryPart& p, Operation& o) { p.operations.resize(65, o); }));
  const auto conflicts = [](auto change) {
    ConflictList list{"c", 0, 1, 1, 5, {{{0, 0, 0}, {4, 0, 0}, 5, {{"robot1", 5, 0}}}}};
    change(list, list.regions[0]);
    return decode<ConflictList>(encode(list, 1)).has_value();
  };
  EXPECT_TRUE(conflicts([](ConflictList&, ConflictRegion&) {}));
  EXPECT_FALSE(conflicts([](ConflictList& l, ConflictRegion&) { l.regions_in_all = -1; }));
  EXPECT_FALSE(conflicts([](ConflictList& l, ConflictRegion&) { l.voxels_in_all = -1; }));
  EXPECT_FALSE(conflicts([](ConflictList& l, ConflictRegion&) { l.parts = 0; }));
  EXPECT_FALSE(conflicts([](ConflictList&, ConflictRegion& r) { r.voxels = 0; }));
  EXPECT_FALSE(conflicts([](ConflictList&, ConflictRegion& r) { r.voxels = 32'769; }));
  EXPECT_FALSE(conflicts([](ConflictList&, ConflictRegion& r) { r.max.x = -1; }));
  EXPECT_FALSE(conflicts([](ConflictList&, ConflictRegion& r) { r.claims[0].agent = "a b"; }));
  EXPECT_FALSE(conflicts([](ConflictList&, ConflictRegion& r) { r.claims[0].occupied = 6; }));
  EXPECT_FALSE(conflicts([](ConflictList&, ConflictRegion& r) { r.claims[0].free = -1; }));
}

TEST(MessagesCorrection, ListsAreChecked) {
  const auto zones = [](auto change) {
    Zone zone;
    zone.name = "dock";
    zone.volume = kBox;
    ListPart<Zone> part{1, 0, 1, {zone}, {}};
    change(part, part.items[0]);
    return decode<ListPart<Zone>>(encode(part, 1)).has_value();
  };
  EXPECT_TRUE(zones([](ListPart<Zone>&, Zone&) {}));
  EXPECT_FALSE(zones([](ListPart<Zone>& p, Zone&) { p.part = -1; }));
  EXPECT_FALSE(zones([](ListPart<Zone>& p, Zone&) { p.parts = 1001; }));
  EXPECT_FALSE(zones([](ListPart<Zone>& p, Zone& z) { p.items.resize(65, z); }));
  EXPECT_FALSE(zones([](ListPart<Zone>&, Zone& z) { z.name = "a/b"; }));
  EXPECT_FALSE(zones([](ListPart<Zone>&, Zone& z) { z.author = "\n"; }));
  EXPECT_FALSE(zones([](ListPart<Zone>&, Zone& z) { z.revision = -1; }));
  EXPECT_FALSE(zones([](ListPart<Zone>&, Zone& z) { z.volume = round(65); }));
  EXPECT_FALSE(zones([](ListPart<Zone>&, Zone& z) { z.volume = Box{{0, 0, kNaN}, {1, 1, 1}}; }));
  EXPECT_FALSE(zones([](ListPart<Zone>&, Zone& z) { z.T_map_zone.translation().x() = kNaN; }));
  Lease lease{"l", "me", kBox, Transform::Identity(), 5};
  EXPECT_TRUE(decode<ListPart<Lease>>(encode(ListPart<Lease>{1, 0, 1, {lease}, {}}, 1)));
  lease.id.clear();
  EXPECT_FALSE(decode<ListPart<Lease>>(encode(ListPart<Lease>{1, 0, 1, {lease}, {}}, 1)));
  EXPECT_FALSE(decode<ListDigest>(encode(ListDigest{1, -1}, 1)));
  EXPECT_FALSE(decode<ListDigest>(encode(ListDigest{1, 8193}, 1)));
}

TEST(MessagesCorrection, AStampThatIsNoTimeIsRefused) {
  for (const std::int64_t none :
       {std::numeric_limits<std::int64_t>::min(), std::int64_t{-1}, std::numeric_limits<std::int64_t>::max()}) {
    const auto pose = decode<AgentPose>(encode(AgentPose{"", "odom", Transform::Identity(), none}));
    ASSERT_FALSE(pose);
    EXPECT_EQ(pose.error().error.code, Code::kBadRequest);
    const auto seen = decode<LocaliseRequest>(encode(LocaliseRequest{"l", "me", "r", Transform::Identity(), {}, none}));
    ASSERT_FALSE(seen);
    EXPECT_EQ(seen.error().error.code, Code::kBadRequest);
    EXPECT_EQ(seen.error().id, "l");
  }
}

}  // namespace
}  // namespace concord::test

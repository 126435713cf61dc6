#include "merge/people.hpp"

#include <cmath>
#include <functional>
#include <limits>

#include <gtest/gtest.h>

#include "core/map_archive.hpp"
#include "merge/edit_evaluation.hpp"

namespace concord {
namespace {

constexpr double kResolution = 0.1;
constexpr std::int64_t kNow = 1'000'000'000;

Shape voxels(std::vector<VoxelBox> boxes) { return VoxelList{kResolution, std::move(boxes)}; }
Shape voxel(VoxelIndex v) { return voxels({{v, v}}); }
Box box(double low, double high) { return {Eigen::Vector3d::Constant(low), Eigen::Vector3d::Constant(high)}; }

/// What people do, one after the other, as the process does it.
class PeopleTest : public ::testing::Test {
 protected:
  void make(const std::string& id, const std::string& author, decltype(Correction::what) what) {
    people_.apply({people_.revision() + 1, id, author, now_, 7, std::move(what)}, touched_);
  }
  EditRequest request(const std::string& id, const std::string& author, Shape shape) {
    EditRequest out;
    out.id = id;
    out.author = author;
    out.shape = std::move(shape);
    return out;
  }
  Code edit(const EditRequest& request) {
    auto made = people_.check(request, T_, map_, now_);
    if (!made) return made.error().code;
    make(request.id, request.author, std::move(*made));
    return kOk;
  }
  Code undo(const std::string& id, const std::string& author, const std::string& edit_id, bool redo = false) {
    const auto made = people_.check(UndoRequest{id, author, edit_id, redo, 0}, now_);
    if (!made) return made.error().code;
    make(id, author, *made);
    return kOk;
  }
  Code zone(const std::string& id, const std::string& author, ZoneRequest::Op op, const std::string& name,
            Volume volume = box(0, 1), std::int64_t base = kAnyRevision) {
    const auto made =
        people_.check(ZoneRequest{id, author, op, name, Zone::Kind::kNoGo, volume, {}, base, 0}, T_, now_);
    if (!made) return made.error().code;
    make(id, author, *made);
    return kOk;
  }
  Code hold(const std::string& id, const std::string& author, Volume volume) {
    auto lease = people_.leases().check(LeaseRequest{"ask", author, id, true, std::move(volume), {}, 0}, T_, now_);
    if (!lease) return lease.error().code;
    people_.leases().hold(std::move(*lease));
    return kOk;
  }

  static constexpr Code kOk = static_cast<Code>(-1);
  People people_{kResolution};
  BrickMap map_;
  Transform T_ = Transform::Identity();
  BrickSet touched_;
  std::int64_t now_ = kNow;
};

TEST_F(PeopleTest, AMoveTakesWhatIsOccupiedAndLeavesItsPlaceFree) {
  VoxelMask mask{};
  mask[0] = 0b11;  // voxels (0, 0, 0) and (1, 0, 0)
  map_.set(BrickIndex{0, 0, 0}, Brick::uniform(mask, kOccupied));
  EditRequest move = request("m", "eva", voxels({{{0, 0, 0}, {3, 3, 3}}}));
  move.op = EditRequest::Op::kMove;
  move.move = {0.14, 0, 0};
  const auto edit = evaluate(move, T_, map_, kResolution);
  ASSERT_TRUE(edit) << edit.error().message;
  EXPECT_EQ(edit->added, (std::vector<VoxelIndex>{{1, 0, 0}, {2, 0, 0}}));
  EXPECT_EQ(edit->deleted, (std::vector<VoxelIndex>{{0, 0, 0}})) << "a voxel left and reached is occupied";
  EXPECT_EQ(edit->op, EditRequest::Op::kMove);
}

TEST_F(PeopleTest, AMoveTurnsWithItsFrame) {
  VoxelMask mask{};
  mask[0] = 1;
  map_.set(BrickIndex{0, 0, 0}, Brick::uniform(mask, kOccupied));
  T_.linear() = Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  EditRequest move = request("m", "eva", voxel({0, 0, 0}));
  move.op = EditRequest::Op::kMove;
  move.move = {0.5, 0, 0};
  EXPECT_EQ(evaluate(move, T_, map_, kResolution)->added, (std::vector<VoxelIndex>{{0, 5, 0}}));
}

TEST_F(PeopleTest, RefusesMovesThatCannotBe) {
  VoxelMask mask{};
  mask[0] = 0b101;  // (0, 0, 0) and (2, 0, 0)
  map_.set(BrickIndex{0, 0, 0}, Brick::uniform(mask, kOccupied));
  EditRequest move = request("m", "eva", voxel({0, 0, 0}));
  move.op = EditRequest::Op::kMove;
  const auto moved = [&](double x) {
    move.move = {x, 0, 0};
    return edit(move);
  };
  EXPECT_EQ(moved(0.2), Code::kCollision);
  EXPECT_EQ(moved(0.04), Code::kBadRequest);
  EXPECT_EQ(moved(4000), Code::kOutOfBounds);
  EXPECT_EQ(moved(1e300), Code::kOutOfBounds);
  move.shape = voxel({1, 0, 0});
  EXPECT_EQ(moved(0.1), Code::kEmpty) << "nothing is occupied there";
  EXPECT_EQ(people_.revision(), 0) << "a refusal changes nothing";
}

TEST_F(PeopleTest, RefusesEditsThatCannotBe) {
  EXPECT_EQ(edit(request("a", "eva", voxels({{{0, 0, 0}, {99, 99, 99}}}))), Code::kTooLarge) << "a million";
  EXPECT_EQ(edit(request("a", "eva", voxel({kMaxVoxel, 0, 0}))), Code::kOutOfBounds);
  EXPECT_EQ(edit(request("a", "eva", voxel({std::numeric_limits<std::int32_t>::min(), 0, 0}))), Code::kOutOfBounds);
  EXPECT_EQ(edit(request("a", "eva", box(NAN, 1))), Code::kNotFinite);
}

TEST_F(PeopleTest, AnEditOnWhatOthersChangedSinceIsStale) {
  ASSERT_EQ(edit(request("a", "eva", voxel({0, 0, 0}))), kOk);
  EditRequest late = request("b", "tom", voxel({0, 0, 0}));
  late.base_revision = 0;
  EXPECT_EQ(edit(late), Code::kStaleRevision);
  late.base_revision = 2;
  EXPECT_EQ(edit(late), Code::kBadRequest);
  late.base_revision = std::numeric_limits<std::int64_t>::max();
  EXPECT_EQ(edit(late), Code::kBadRequest);
  late.base_revision = 1;
  EXPECT_EQ(edit(late), kOk);
  late.id = "c";
  late.shape = voxel({0, 0, 1});
  late.base_revision = 0;
  EXPECT_EQ(edit(late), kOk) << "other voxels were changed";
  ASSERT_EQ(undo("u", "eva", "a"), kOk);
  late.id = "d";
  late.shape = voxel({0, 0, 0});
  late.base_revision = 3;
  EXPECT_EQ(edit(late), Code::kStaleRevision) << "an undo is a change";
}

TEST_F(PeopleTest, ALeaseKeepsOthersOut) {
  ASSERT_EQ(edit(request("a", "tom", voxel({5, 5, 5}))), kOk);
  ASSERT_EQ(hold("l", "eva", box(0, 1)), kOk);
  EXPECT_EQ(edit(request("b", "tom", voxels({{{9, 9, 9}, {12, 9, 9}}}))), Code::kLocked) << "one voxel in it";
  EXPECT_EQ(edit(request("b", "tom", voxels({{{10, 9, 9}, {12, 9, 9}}}))), kOk) << "beside it";
  EXPECT_EQ(undo("u", "tom", "a"), Code::kLocked);
  EXPECT_EQ(zone("z", "tom", ZoneRequest::Op::kAdd, "door", box(0.5, 2)), Code::kLocked);
  EXPECT_EQ(hold("m", "tom", box(0.5, 2)), Code::kLocked);
  EXPECT_EQ(hold("l", "tom", box(5, 6)), Code::kLocked) << "eva's id";
  EXPECT_EQ(people_.leases().free(LeaseRequest{"ask", "tom", "l", false, box(0, 1), {}, 0}, now_).error().code,
            Code::kLocked);
  EXPECT_EQ(hold("m", "tom", box(1, 2)), kOk) << "wall to wall";
  EXPECT_EQ(edit(request("c", "eva", voxel({5, 5, 5}))), kOk) << "its holder is not kept out";
  EXPECT_EQ(hold("n", "eva", box(0.5, 0.9)), kOk);
  now_ += kLeaseTime;
  EXPECT_EQ(undo("u", "tom", "a"), kOk) << "over";
}

TEST_F(PeopleTest, ALeaseIsRenewedMovedAndFreed) {
  ASSERT_EQ(hold("l", "eva", box(0, 1)), kOk);
  now_ += kLeaseTime / 2;
  ASSERT_EQ(hold("l", "eva", box(3, 4)), kOk);
  now_ += kLeaseTime / 2;
  EXPECT_FALSE(people_.leases().expire(now_));
  ASSERT_EQ(people_.leases().list().size(), 1u);
  EXPECT_EQ(edit(request("a", "tom", voxel({5, 5, 5}))), kOk) << "it was moved away";
  EXPECT_EQ(edit(request("b", "tom", voxel({35, 35, 35}))), Code::kLocked);
  const LeaseRequest free{"ask", "eva", "l", false, box(0, 1), {}, 0};
  EXPECT_TRUE(*people_.leases().free(free, now_));
  EXPECT_FALSE(*people_.leases().free(free, now_)) << "freed twice is free";
  EXPECT_EQ(edit(request("b", "tom", voxel({35, 35, 35}))), kOk);
}

TEST_F(PeopleTest, ThinTurnedLeasesKeepOutOfJustThemselves) {
  OrientedBox pane{Transform::Identity(), {20, 0.3, 20}};
  pane.T_frame_box.linear() = Eigen::AngleAxisd(M_PI / 4, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  ASSERT_EQ(hold("l", "eva", pane), kOk);
  for (std::int32_t x = -30; x < 30; ++x) {
    for (std::int32_t y = -30; y < 30; ++y) {
      const bool held = contains(pane, Transform::Identity(), centre_of({x, y, 3}, kResolution));
      const auto made = people_.check(request("a", "tom", voxel({x, y, 3})), T_, map_, now_);
      ASSERT_EQ(!made, held) << x << ' ' << y;
    }
  }
}

TEST_F(PeopleTest, WhatIsDearToTellIsLocked) {
  // A comb whose teeth miss all centres: every voxel is near, none is in it.
  Prism comb{{}, -10, 10};
  for (int i = 0; i < 15; ++i) {
    comb.points.emplace_back(i * 0.6, 0.0);
    comb.points.emplace_back(i * 0.6, 9.0);
    comb.points.emplace_back(i * 0.6 + 0.01, 9.0);
    comb.points.emplace_back(i * 0.6 + 0.01, 0.0);
  }
  comb.points.emplace_back(9.0, -0.01);
  comb.points.emplace_back(0.0, -0.01);
  ASSERT_TRUE(check(Volume(comb)));
  const EditRequest large = request("a", "tom", voxels({{{0, 0, 0}, {78, 78, 78}}}));
  ASSERT_EQ(hold("l0", "eva", comb), kOk);
  EXPECT_TRUE(people_.check(large, T_, map_, now_)) << "one such lease is looked at";
  for (int i = 1; i < 3; ++i) ASSERT_EQ(hold("l" + std::to_string(i), "eva", comb), kOk);
  EXPECT_EQ(edit(large), Code::kLocked);
}

TEST_F(PeopleTest, NobodyHoldsAllOrEverything) {
  EXPECT_EQ(hold("l", "eva", box(0, 20.1)), Code::kTooLarge);
  for (int i = 0; i < 4; ++i) ASSERT_EQ(hold("l" + std::to_string(i), "eva", box(0, 20)), kOk);
  EXPECT_EQ(hold("l4", "eva", box(0, 1)), Code::kBusy);
  EXPECT_EQ(hold("l3", "eva", box(0, 1)), kOk) << "a renewal";
  EXPECT_EQ(hold("t", "tom", box(30, 31)), kOk);
}

TEST_F(PeopleTest, LeasesAreBounded) {
  for (std::size_t i = 0; i < kMaxLeases; ++i) {
    ASSERT_EQ(hold("l" + std::to_string(i), "eva" + std::to_string(i / 4),
                   box(2.0 * static_cast<double>(i), 2.0 * static_cast<double>(i) + 1)),
              kOk);
  }
  EXPECT_EQ(hold("more", "eva", box(-2, -1)), Code::kBusy);
  EXPECT_EQ(hold("l0", "eva0", box(-2, -1)), kOk) << "a renewal needs no room";
  now_ += kLeaseTime;
  EXPECT_EQ(hold("more", "eva", box(-2, -1)), kOk);
}

TEST_F(PeopleTest, ZonesAreAddedChangedAndDeleted) {
  using Op = ZoneRequest::Op;
  ASSERT_EQ(zone("1", "eva", Op::kAdd, "door"), kOk);
  EXPECT_EQ(zone("2", "tom", Op::kAdd, "door"), Code::kExists);
  EXPECT_EQ(zone("2", "tom", Op::kChange, "gate"), Code::kNotFound);
  EXPECT_EQ(zone("2", "tom", Op::kDelete, "gate"), Code::kNotFound);
  EXPECT_EQ(zone("2", "tom", Op::kAdd, "far", box(3270, 3280)), Code::kOutOfBounds);
  EXPECT_EQ(zone("2", "tom", Op::kChange, "door", box(0, 2), 9), Code::kBadRequest);
  ASSERT_EQ(zone("2", "tom", Op::kChange, "door", box(0, 2), 1), kOk);
  EXPECT_EQ(people_.zones().at("door").author, "tom");
  EXPECT_EQ(people_.zones().at("door").revision, 2);
  EXPECT_EQ(zone("3", "eva", Op::kDelete, "door", box(0, 1), 1), Code::kStaleRevision);
  EXPECT_EQ(zone("3", "eva", Op::kDelete, "door", box(0, 1), 2), kOk);
  EXPECT_TRUE(people_.zones().empty());
  EXPECT_EQ(zone("4", "eva", Op::kAdd, "door"), kOk) << "the name is free again";
}

TEST_F(PeopleTest, ZonesAreBounded) {
  for (std::size_t i = 0; i < kMaxZones; ++i) {
    ASSERT_EQ(zone("z" + std::to_string(i), "eva", ZoneRequest::Op::kAdd, "zone" + std::to_string(i)), kOk);
  }
  EXPECT_EQ(zone("more", "eva", ZoneRequest::Op::kAdd, "more"), Code::kTooLarge);
  EXPECT_EQ(zone("change", "eva", ZoneRequest::Op::kChange, "zone7"), kOk);
}

TEST_F(PeopleTest, AZoneUnderALeaseIsNotTakenAway) {
  ASSERT_EQ(zone("1", "eva", ZoneRequest::Op::kAdd, "door", box(0, 1)), kOk);
  ASSERT_EQ(hold("l", "eva", box(0.5, 3)), kOk);
  EXPECT_EQ(zone("2", "tom", ZoneRequest::Op::kDelete, "door"), Code::kLocked);
  EXPECT_EQ(zone("2", "tom", ZoneRequest::Op::kChange, "door", box(5, 6)), Code::kLocked) << "it was there";
  EXPECT_EQ(zone("2", "eva", ZoneRequest::Op::kDelete, "door"), kOk);
}

TEST_F(PeopleTest, TheHistoryIsFiltered) {
  ASSERT_EQ(edit(request("a", "eva", voxel({0, 0, 0}))), kOk);
  now_ += 10;
  ASSERT_EQ(edit(request("b", "tom", voxels({{{1, 1, 1}, {1, 1, 3}}}))), kOk);
  now_ += 10;
  ASSERT_EQ(undo("u", "tom", "a"), kOk);
  ASSERT_EQ(zone("z", "eva", ZoneRequest::Op::kAdd, "door"), kOk);
  make("t", "eva", Correction::Placement{"robot1", "f", 1, true, Transform::Identity()});
  make("w", "eva", Correction::Weight{"robot1", 3});
  const auto ids = [&](const std::function<void(HistoryRequest&)>& narrow) {
    HistoryRequest asked;
    narrow(asked);
    std::string out;
    for (const Operation& operation : people_.history(asked)) out += operation.id;
    return out;
  };
  EXPECT_EQ(ids([](HistoryRequest&) {}), "abuztw");
  EXPECT_EQ(ids([](HistoryRequest& r) { r.author = "tom"; }), "bu");
  EXPECT_EQ(ids([](HistoryRequest& r) { r.subject = "a"; }), "au") << "the edit and its undoing";
  EXPECT_EQ(ids([](HistoryRequest& r) { r.subject = "robot1"; }), "tw");
  EXPECT_EQ(ids([](HistoryRequest& r) { r.kind = Operation::Kind::kZoneAdd; }), "z");
  EXPECT_EQ(ids([](HistoryRequest& r) { r.since = kNow + 10; }), "buztw");
  EXPECT_EQ(ids([](HistoryRequest& r) {
              r.since = kNow + 10;
              r.until = kNow + 20;
            }),
            "b");
  EXPECT_EQ(ids([](HistoryRequest& r) { r.after_revision = 4; }), "tw");
  EXPECT_EQ(ids([](HistoryRequest& r) { r.after_revision = 40; }), "");
  EXPECT_EQ(ids([](HistoryRequest& r) { r.most = 2; }), "ab");
  const auto all = people_.history({});
  EXPECT_FALSE(all[0].active);
  EXPECT_TRUE(all[1].active);
  EXPECT_EQ(all[1].count, 3);
  EXPECT_EQ(all[1].max, (VoxelIndex{1, 1, 3}));
}

TEST_F(PeopleTest, APlacementHoldsForItsFrameAndIncarnation) {
  make("t", "eva", Correction::Placement{"robot1", "f", 1, true, T_});
  EXPECT_NE(people_.T_map_agent("robot1", "f", 1), nullptr);
  EXPECT_EQ(people_.T_map_agent("robot1", "f", 2), nullptr);
  EXPECT_EQ(people_.T_map_agent("robot1", "g", 1), nullptr);
  EXPECT_EQ(people_.T_map_agent("robot2", "f", 1), nullptr);
  EXPECT_EQ(people_.weight("robot1"), std::nullopt);
  make("w", "eva", Correction::Weight{"robot1", 3});
  EXPECT_EQ(people_.weight("robot1"), 3);
  ASSERT_NE(people_.find("w"), nullptr);
  EXPECT_EQ(people_.find("w")->operation.revision, 2);
  EXPECT_EQ(people_.find("x"), nullptr);
}

TEST_F(PeopleTest, WhereAnAgentWasPlacedByItsPosesItsLayerLies) {
  Transform later = T_;
  later.translation().x() += 1;
  make("s1", "eva", Correction::Placement{"robot1", "f", 7, true, T_});
  make("p1", "tom", Correction::Placement{"robot1", "f", 0, false, later});
  ASSERT_NE(people_.T_map_agent("robot1", "f", 7), nullptr);
  EXPECT_EQ(people_.T_map_agent("robot1", "f", 7)->translation(), later.translation()) << "the later one";
  EXPECT_NE(people_.T_map_agent("robot1", "f", 8), nullptr);
  EXPECT_EQ(people_.T_map_agent("robot1", "g", 8), nullptr) << "another frame";
  EXPECT_EQ(people_.T_map_agent("robot1", "f", kLoadedIncarnation), nullptr) << "a file tells where its layers lie";
  EXPECT_EQ(people_.carried_over("robot1", "g", 8, 5), std::nullopt);
  const auto carried = people_.carried_over("robot1", "f", 8, 5);
  ASSERT_TRUE(carried);
  EXPECT_EQ(carried->id, "carried-2");
  EXPECT_EQ(carried->author, "tom");
  EXPECT_EQ(carried->revision, 3);
  BrickSet touched;
  people_.apply(*carried, touched);
  EXPECT_EQ(people_.carried_over("robot1", "f", 8, 5), std::nullopt) << "once";
  EXPECT_NE(people_.T_map_agent("robot1", "f", 8), nullptr);
  EXPECT_EQ(people_.T_map_agent("robot1", "f", 9), nullptr) << "it was for the one before";
  EXPECT_EQ(people_.T_map_agent("robot1", "f", 0), nullptr);
}

TEST_F(PeopleTest, WhatIsNobodysIsHistoryOnly) {
  make("p1", "tom", Correction::Placement{"robot1", "f", 0, false, T_});
  make("n1", "tom", Correction::Placement{"robot1", "f", kNobodys, true, Transform::Identity()});
  ASSERT_NE(people_.T_map_agent("robot1", "f", 0), nullptr);
  EXPECT_EQ(people_.T_map_agent("robot1", "f", kNobodys), nullptr);
  EXPECT_EQ(people_.placements().at("robot1").size(), 1u);
  EXPECT_NE(people_.find("n1"), nullptr);
}

}  // namespace
}  // namespace concord

#include <gtest/gtest.h>

#include "align/align_desk.hpp"
#include "align/drift_watch.hpp"
#include "rooms.hpp"

namespace concord::test {
namespace {

constexpr std::int64_t kNow = 1'000'000'000;

/// robot1 and robot2 in the map, and robot3, which is not.
AgentLayers three_layers() {
  AgentLayers layers;
  for (const char* agent : {"robot1", "robot2", "robot3"}) {
    layers[agent].frame_id = "frame1";
    layers[agent].revision = 7;
    layers[agent].synced = true;
  }
  layers["robot1"].T_map_agent = Transform::Identity();
  layers["robot2"].T_map_agent = transform(5, 0, 0, 0);
  return layers;
}

Alignment accepted_alignment() {
  Alignment out;
  out.reason = AlignReason::kAccepted;
  return out;
}

AlignTask task_of(const std::string& id, const AgentLayers& layers) {
  AlignTask task;
  task.id = id;
  task.used_source = {"robot2", "frame1", 7};
  task.target.push_back({"robot1", {}, *layers.at("robot1").T_map_agent, 1});
  task.used_layers.push_back({"robot1", "frame1", 7});
  return task;
}

AlignTask recheck_of(const std::string& id, const AgentLayers& layers) {
  AlignTask task = task_of(id, layers);
  task.is_recheck = true;
  task.T_target_source = layers.at("robot2").T_map_agent;
  return task;
}

class Desk : public ::testing::Test {
 protected:
  AlignDesk desk_;
  AgentLayers layers_ = three_layers();
  std::int64_t now_ = kNow;

  void ask(const std::string& id) {
    AlignRequest request;
    request.id = id;
    request.source = "robot2";
    ASSERT_TRUE(desk_.take(request, 1));
  }
  void find_next(const std::string& id) {
    const AlignRequest* next = desk_.begin_next();
    ASSERT_NE(next, nullptr);
    ASSERT_EQ(next->id, id);
    const AlignTask task = task_of(id, layers_);
    ASSERT_NE(desk_.finish(task, result_of(task, accepted_alignment(), now_)), nullptr);
  }
  void ask_and_find(const std::string& id) {
    ask(id);
    find_next(id);
  }
  /// @return whether people are told.
  bool offer(const std::string& id, const Alignment& found = accepted_alignment()) {
    const AlignTask task = recheck_of(id, layers_);
    return desk_.offer(task, result_of(task, found, now_)) != nullptr;
  }
  Result<void> drop(const std::string& id) {
    return desk_.drop({"drop-" + id, "eva", AlignDecision::Op::kDrop, id, now_});
  }
  Result<AlignDesk::Acceptance> accept(const std::string& decision, const std::string& id) {
    return desk_.accept({decision, "eva", AlignDecision::Op::kAccept, id, now_}, layers_, true, now_);
  }
  [[nodiscard]] std::size_t said() { return desk_.standing(layers_, now_).size(); }
};

TEST_F(Desk, ForgetsTheOldestAnswerAndNeverWhatWaitsOrIsOffered) {
  offer("slip");
  for (std::size_t i = 0; i < AlignDesk::kMaxKept; ++i) ask_and_find("a" + std::to_string(i));
  ask("runs");
  ask("waits");
  EXPECT_TRUE(accept("d", "a0"));
  find_next("runs");
  EXPECT_EQ(accept("e", "waits").error().code, Code::kBusy);
  EXPECT_EQ(accept("e", "a0").error().code, Code::kExpired);
  EXPECT_TRUE(accept("f", "a1"));
  EXPECT_TRUE(desk_.has_offer("robot2"));
}

TEST_F(Desk, AnOfferIsWithdrawnWhenAnybodyItIsAboutLiesElsewhere) {
  const auto withdrawn_after = [&](const auto& change) {
    layers_ = three_layers();
    offer("slip");
    desk_.heed(layers_);
    EXPECT_TRUE(desk_.has_offer("robot2"));
    change();
    desk_.heed(layers_);
    return !desk_.has_offer("robot2");
  };
  EXPECT_TRUE(withdrawn_after([&] { layers_["robot1"].T_map_agent = transform(0, 0.1, 0, 0); }));
  EXPECT_TRUE(withdrawn_after([&] { layers_["robot1"].frame_id = "frame2"; }));
  EXPECT_TRUE(withdrawn_after([&] { layers_.erase("robot1"); }));
  EXPECT_TRUE(withdrawn_after([&] { layers_["robot2"].T_map_agent = transform(5, 0.1, 0, 0); }));
  EXPECT_TRUE(withdrawn_after([&] { layers_["robot2"].frame_id = "frame2"; }));
  EXPECT_FALSE(withdrawn_after([&] { layers_["robot3"].T_map_agent = transform(9, 0, 0, 0); }));
  EXPECT_FALSE(withdrawn_after([&] { layers_["robot1"].revision = 8; }));
}

TEST_F(Desk, AnOfferExpiresAndItsAgentIsNamed) {
  offer("slip");
  now_ += AlignDesk::kOpenFor;
  EXPECT_TRUE(desk_.expire_offers(now_).empty());
  EXPECT_EQ(said(), 1U);
  now_ += 1;
  EXPECT_EQ(desk_.expire_offers(now_), std::vector<std::string>{"robot2"});
  EXPECT_EQ(said(), 0U);
  EXPECT_EQ(desk_.offers(), 0U);
}

TEST_F(Desk, WhatPeopleDroppedIsNotOfferedAgainWhileTheAgentMapsOn) {
  const auto found_at = [](double x, double yaw) {
    Alignment out = accepted_alignment();
    out.T_target_source = transform(5 + x, 0, 0, yaw);
    return out;
  };
  ASSERT_TRUE(offer("slip1", found_at(0.3, 0)));
  ASSERT_TRUE(drop("slip1"));
  EXPECT_TRUE(drop("slip1")) << "the answer may have been lost";
  layers_["robot2"].revision = 8;
  desk_.heed(layers_);
  EXPECT_FALSE(offer("slip2", found_at(0.3, 0)));
  EXPECT_FALSE(offer("slip3", found_at(0.39, degrees(1.4)))) << "it is the same slip";
  EXPECT_EQ(said(), 0U);
  EXPECT_TRUE(offer("slip4", found_at(0.41, 0))) << "it slipped farther";
  EXPECT_TRUE(offer("slip5", found_at(0.3, degrees(1.6)))) << "it turned";
  EXPECT_FALSE(offer("slip6", found_at(0.3, 0)));
  EXPECT_EQ(said(), 0U) << "what was said no longer holds, and what holds was dropped";
  layers_["robot2"].T_map_agent = transform(5, 0.01, 0, 0);
  desk_.heed(layers_);
  EXPECT_TRUE(offer("slip7", found_at(0.3, 0))) << "it was placed anew";
  layers_["robot2"].T_map_agent = transform(5, 0, 0, 0);
  desk_.heed(layers_);
  EXPECT_TRUE(offer("slip8", found_at(0.3, 0))) << "it was placed anew, where it lay before";
}

TEST_F(Desk, ADroppedContradictionIsSaidAgainWhenMoreSpeaksAgainstThePlace) {
  const auto against = [](double share) {
    Alignment out;
    out.reason = AlignReason::kDiverged;
    out.against_upright = share;
    return out;
  };
  ASSERT_TRUE(offer("slip1", against(0.10)));
  ASSERT_TRUE(drop("slip1"));
  EXPECT_FALSE(offer("slip2", against(0.14)));
  EXPECT_TRUE(offer("slip3", against(0.16)));
  EXPECT_TRUE(offer("slip4")) << "now it is known how it lies right";
}

TEST_F(Desk, IsAcceptedOnceMergeAgrees) {
  ask_and_find("a");
  ASSERT_TRUE(accept("d", "a"));
  EXPECT_EQ(said(), 1U) << "merge has not answered";
  desk_.on_merge("d", false);
  ASSERT_TRUE(accept("e", "a")) << "merge refused it";
  ASSERT_TRUE(accept("f", "a")) << "merge says nothing";
  desk_.on_merge("e", true);
  EXPECT_EQ(said(), 1U) << "another decision took its place";
  desk_.on_merge("f", true);
  EXPECT_EQ(said(), 0U);
  EXPECT_EQ(accept("g", "a").error().code, Code::kConflict);
  EXPECT_TRUE(accept("f", "a")) << "its answer may have been lost";
}

TEST(DriftWatch, LooksAgainAtWhatChangedWhileItLooked) {
  DriftWatch watch;
  AgentLayers layers = three_layers();
  std::int64_t now = kNow;
  const auto look = [&](const auto& meanwhile) {
    const auto agent = watch.next(layers, now);
    if (!agent) return std::string();
    DriftWatch::Look begun = DriftWatch::begin(*agent, layers);
    meanwhile();
    watch.looked_at(std::move(begun), 1000, now);
    now += 2 * DriftWatch::kLeastPause;
    return *agent;
  };
  const auto nothing = [] {};
  EXPECT_EQ(look(nothing), "robot1");
  EXPECT_EQ(look([&] { layers["robot2"].revision = 9; }), "robot2");
  EXPECT_EQ(look(nothing), "robot2") << "what was sent while it was looked at is unseen";
  EXPECT_EQ(look(nothing), "");
  layers["robot1"].T_map_agent = transform(0, 1, 0, 0);
  EXPECT_EQ(look(nothing), "robot1");
  EXPECT_EQ(look(nothing), "robot2") << "the other one was moved";
  EXPECT_EQ(look(nothing), "");
  watch.forget("robot1");
  EXPECT_EQ(look(nothing), "robot1");
  EXPECT_EQ(look(nothing), "");
}

TEST(DriftWatch, PausesNineteenTimesAsLongAsItLooked) {
  DriftWatch watch;
  const AgentLayers layers = three_layers();
  watch.looked_at(DriftWatch::begin("robot1", layers), 1'000'000, kNow);
  EXPECT_FALSE(watch.next(layers, kNow + 18'999'999));
  EXPECT_EQ(watch.next(layers, kNow + 19'000'000), "robot2");
}

}  // namespace
}  // namespace concord::test

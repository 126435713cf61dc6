#include "cli/load_archive.hpp"

#include <unistd.h>

#include <fstream>

#include <gtest/gtest.h>

namespace concord {
namespace {

/// Ingest and merge, played on the client's own bus.
class LoadArchive : public testing::Test {
 protected:
  void SetUp() override {
    std::ofstream(site_) << "lcm_url: memq://\n";
    common_.site_file = site_;
    common_.timeout = 2.0;
    live_ = std::make_unique<Live>(common_);
    request_ = {live_->new_id(), MapRequest::Op::kLoad, "hall", {"concord"}, false, ""};
  }
  void TearDown() override { std::filesystem::remove(site_); }

  void say(const std::string& process, Code code, bool ok = false) {
    answer(live_->bus(), {request_.id, process, ok, ok ? "OK" : name(code), "said so", 0, 0});
  }

  /// Each request is answered by `reply(how often it was heard)`.
  template <class Reply>
  Outcome load(Reply reply) {
    live_->hear<MapRequest>("in/map_request",
                            [this, reply](const std::string&, const MapRequest&) { reply(++heard_); });
    testing::internal::CaptureStdout();
    const Outcome outcome = load_archive(*live_, request_, common_);
    static_cast<void>(testing::internal::GetCapturedStdout());
    return outcome;
  }

  std::filesystem::path site_ =
      std::filesystem::path(testing::TempDir()) / ("load" + std::to_string(getpid()) + ".yaml");
  Common common_;
  std::unique_ptr<Live> live_;
  MapRequest request_;
  int heard_ = 0;
};

TEST_F(LoadArchive, AsksAgainWhileMergeWaitsForTheLayers) {
  const Outcome outcome = load([this](int heard) {
    say("ingest", Code::kBusy, true);
    say("merge", Code::kBusy, heard == 2);
  });
  ASSERT_TRUE(outcome) << outcome.error().message;
  EXPECT_EQ(heard_, 2);
}

TEST_F(LoadArchive, IngestsRefusalEndsIt) {
  const Outcome outcome = load([this](int) {
    say("merge", Code::kBusy);
    say("ingest", Code::kExists);
  });
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().exit, Exit::kRefused);
  EXPECT_EQ(outcome.error().code, "EXISTS");
  EXPECT_EQ(heard_, 1);
}

TEST_F(LoadArchive, WhatIsHalfLoadedIsToldHowToGoOn) {
  const Outcome outcome = load([this](int) {
    say("ingest", Code::kBusy, true);
    say("merge", Code::kExists);
  });
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().code, "EXISTS");
  EXPECT_NE(outcome.error().message.find("--id " + request_.id), std::string::npos) << outcome.error().message;
}

TEST_F(LoadArchive, BothMustHaveDoneIt) {
  const Outcome outcome = load([this](int) { say("ingest", Code::kBusy, true); });
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().exit, Exit::kNoAnswer);
}

TEST_F(LoadArchive, AMergeThatStaysBusyIsToldWithTheIdToGoOnWith) {
  const Outcome outcome = load([this](int) {
    say("ingest", Code::kBusy, true);
    say("merge", Code::kBusy);
  });
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().exit, Exit::kIncomplete);
  EXPECT_NE(outcome.error().message.find("--id " + request_.id), std::string::npos);
}

TEST_F(LoadArchive, ItWaitsAsLongAsLayersArrive) {
  AgentList list{0, 0.1, {}};
  list.agents.resize(1);
  list.agents[0].id = "robot1";
  live_->bus().every(300'000, [&] {
    list.agents[0].known += 100;
    live_->bus().publish("out/agents", encode(list));
  });
  const Outcome outcome = load([this](int heard) {
    say("ingest", Code::kBusy, true);
    say("merge", Code::kBusy, heard == 8);  // over twice the timeout
  });
  EXPECT_TRUE(outcome);
}

TEST_F(LoadArchive, ItsLayersKeepTheirIds) {
  request_.agent = "other";
  const Outcome outcome = load([](int) {});
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().exit, Exit::kUnusable);
  EXPECT_EQ(heard_, 0);
}

}  // namespace
}  // namespace concord

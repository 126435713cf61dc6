// Sessions that outlive their connection.

#include "bridge_test.hpp"

namespace concord::hmd {
namespace {

/// What was emptied while its connection was dying it never heard; here it is forgotten meanwhile.
TEST_F(Bridge, WhoMissedThatABlockWasEmptiedBeginsAnew) {
  const Json first = ana.hello()["answer"];
  place_robot();
  const Shape far = box(20, 20, 0.2, 20.4, 20.4, 0.6);
  EXPECT_CODE(ana.ask(add(far)), "OK");
  EXPECT_CODE(ana.ask(ViewRequest{Layer::kMap, {}, Frame::kMap, {0, 0, 0}, {1000}, {}}), "OK");
  ana.note(CreditNotice{10'000'000});
  lab.run(0.5);
  ana.read();
  const Json complete = ana.events["complete"];
  EXPECT_CODE(ana.ask(EditRequest{EditOp::kDelete, Frame::kMap, far, {}, {}}), "OK");
  lab.run(0.5);
  EXPECT_CODE(ana.ask(add(box(1, 1, 0.2, 1.5, 1.5, 0.5))), "OK");
  lab.run(25);  // it is swept up
  ana.lose();
  Client back(lab);
  HelloRequest hello;
  hello.version = kProtocol;
  hello.name = "ana";
  hello.resume = Resume{first["session"], complete["epoch"], complete["revision"]};
  ASSERT_TRUE(back.ask_text(50, request_text(50, hello))["answer"]["resumed"].get<bool>());
  EXPECT_EQ(back.events["epoch"]["stream"], 0) << "it is to drop what it has";
}

TEST_F(Bridge, ALostSessionGoesOnAndNothingIsDoneTwice) {
  const Json first = ana.hello()["answer"];
  place_robot();
  EXPECT_CODE(ana.ask(ViewRequest{Layer::kMap, {}, Frame::kMap, {0, 0, 0}, {1000}, {}}), "OK");
  lab.run(0.5);
  ana.read();
  const Json complete = ana.events["complete"];
  const std::string edit = request_text(ana.next_id(), add(box(1, 1, 0.2, 1.5, 1.5, 0.5)));
  const std::int64_t id = ana.last_id();
  lab.bridge->hub().text(ana.connection, edit, lab.bus->now());
  ana.lose();  // before the answer
  lab.run(1);

  Client back(lab);
  HelloRequest hello;
  hello.version = kProtocol;
  hello.name = "ana";
  hello.resume = Resume{first["session"], complete["epoch"], complete["revision"]};
  const Json resumed = back.ask_text(id + 1, request_text(id + 1, hello));
  ASSERT_TRUE(resumed["answer"]["resumed"].get<bool>()) << resumed;
  EXPECT_CODE(back.ask_text(id, edit), "OK");
  const Json history =
      back.ask_text(id + 2, request_text(id + 2, HistoryRequest{{}, {}, OperationKind::kAdd, {}, 100}));
  EXPECT_EQ(history["answer"]["operations"].size(), 1u) << history;
  back.note(CreditNotice{1'000'000});
  const Json view =
      back.ask_text(id + 3, request_text(id + 3, ViewRequest{Layer::kMap, {}, Frame::kMap, {0, 0, 0}, {1000}, {}}));
  EXPECT_CODE(view, "OK");
  lab.run(0.3);
  back.read();
  ASSERT_EQ(back.frames.size(), 1u) << "just the block that changed";
  EXPECT_FALSE(back.frames[0].head.whole);
}

TEST_F(Bridge, WhatNeverArrivedIsAskedAfterTheResumeUnderItsOldId) {
  const Json first = ana.hello()["answer"];
  place_robot();
  const std::int64_t lost = ana.next_id();
  ana.lose();
  Client back(lab);
  HelloRequest hello;
  hello.version = kProtocol;
  hello.name = "ana";
  hello.resume = Resume{first["session"], "", 0};
  ASSERT_TRUE(back.ask_text(lost + 1, request_text(lost + 1, hello))["answer"]["resumed"].get<bool>());
  EXPECT_CODE(back.ask_text(lost, request_text(lost, add(box(1, 1, 0.2, 1.5, 1.5, 0.5)))), "OK");
  EXPECT_CODE(back.ask_text(lost + 2, request_text(lost + 2, AgentsRequest{})), "OK");
}

/// Somebody who has region A whole comes back after a view of B of which nothing arrived.
TEST_F(Bridge, AResumeAfterAnotherViewDropsWhatTheServerCannotKnow) {
  const Json first = ana.hello()["answer"];
  place_robot();
  EXPECT_CODE(ana.ask(ViewRequest{Layer::kMap, {}, Frame::kMap, {0, 0, 0}, {1}, {}}), "OK");
  lab.run(0.5);
  ana.read();
  const Json complete = ana.events["complete"];
  ana.frames.clear();
  ASSERT_EQ(code_of_answer(ana.ask(ViewRequest{Layer::kMap, {}, Frame::kMap, {0, 0, 0}, {1000}, {}})), "OK");
  ana.lose();
  Client back(lab);
  HelloRequest hello;
  hello.version = kProtocol;
  hello.name = "ana";
  hello.resume = Resume{first["session"], complete["epoch"], complete["revision"].get<std::int64_t>() - 1};
  ASSERT_TRUE(back.ask_text(10, request_text(10, hello))["answer"]["resumed"].get<bool>());
  EXPECT_EQ(back.events["epoch"]["stream"], 0) << "it is to drop what it has";
  back.note(CreditNotice{1'000'000});
  const Json view =
      back.ask_text(11, request_text(11, ViewRequest{Layer::kMap, {}, Frame::kMap, {0, 0, 0}, {1000}, {}}));
  EXPECT_EQ(view["answer"]["lacking"], view["answer"]["blocks"]);
}

TEST_F(Bridge, WhoLooksElsewhereFirstAfterAResumeForgetsWhatItHad) {
  const Json first = ana.hello()["answer"];
  place_robot();
  EXPECT_CODE(ana.ask(ViewRequest{Layer::kMap, {}, Frame::kMap, {0, 0, 0}, {1000}, {}}), "OK");
  lab.run(0.5);
  ana.read();
  const Json complete = ana.events["complete"];
  ana.lose();
  Client back(lab);
  HelloRequest hello;
  hello.version = kProtocol;
  hello.name = "ana";
  hello.resume = Resume{first["session"], complete["epoch"], complete["revision"]};
  ASSERT_TRUE(back.ask_text(10, request_text(10, hello))["answer"]["resumed"].get<bool>());
  back.note(CreditNotice{1'000'000});
  EXPECT_CODE(back.ask_text(11, request_text(11, ViewRequest{Layer::kMap, {}, Frame::kMap, {500, 0, 0}, {1}, {}})),
              "OK");
  lab.run(0.3);
  back.read();
  ASSERT_EQ(back.frames.size(), 1u);
  EXPECT_EQ(back.frames[0].head.kind, FrameKind::kForget) << "else old blocks are drawn over new ones";
}

TEST_F(Bridge, FramesOfALostAnswerComeAgainWithIt) {
  const Json first = ana.hello()["answer"];
  place_robot();
  const std::int64_t id = ana.next_id();
  const std::string ask = request_text(id, MinimapRequest{"robot1", 0.5});
  lab.bridge->hub().text(ana.connection, ask, lab.bus->now());
  lab.run(1);
  ana.lose();  // the points and the answer wait to be written
  Client back(lab);
  HelloRequest hello;
  hello.version = kProtocol;
  hello.name = "ana";
  hello.resume = Resume{first["session"], "", 0};
  ASSERT_TRUE(back.ask_text(id + 1, request_text(id + 1, hello))["answer"]["resumed"].get<bool>());
  EXPECT_CODE(back.ask_text(id, ask), "OK");
  ASSERT_EQ(back.frames.size(), 1u);
  EXPECT_EQ(back.frames[0].head.kind, FrameKind::kPoints);
}

class Parked : public Bridge {
 protected:
  /// Somebody comes in from this address with a token, or from this machine, and loses the connection.
  std::string park(const std::string& name, const Peer& peer) {
    Client client(lab, peer);
    const std::string session = client.ask(hello(name, peer))["answer"]["session"];
    client.lose();
    lab.run(0.1);
    return session;
  }
  bool is_kept(const std::string& name, const Peer& peer, const std::string& session) {
    HelloRequest again = hello(name, peer);
    again.resume = Resume{session, "", 0};
    Client client(lab, peer);
    return client.ask(again)["answer"]["resumed"].get<bool>();
  }

 private:
  HelloRequest hello(const std::string& name, const Peer& peer) {
    HelloRequest hello;
    hello.version = kProtocol;
    hello.name = name;
    if (!peer.local) hello.ticket = lab.gate->issue({name, Role::kEdit}, lab.bus->now());
    return hello;
  }
};

TEST_F(Parked, OneAddressDrivesOutNoSessionButItsOwn) {
  const Peer other{"10.0.0.8", false}, many{"10.0.0.7", false};
  const std::string others = park("bert", other);
  std::vector<std::string> of_many;
  for (int i = 0; i < Hub::kMaxParkedOfOne + 1; ++i) of_many.push_back(park("carl", many));
  lab.run(1);
  EXPECT_FALSE(is_kept("carl", many, of_many[0])) << "their oldest is one too many";
  EXPECT_TRUE(is_kept("carl", many, of_many[1]));
  EXPECT_TRUE(is_kept("bert", other, others)) << "older, and not theirs";
}

TEST_F(Parked, WhoNeedsNoTokenIsKeptWhenTokensGo) {
  const Peer local{"127.0.0.1", true}, other{"10.0.0.8", false};
  ASSERT_TRUE(has_code(ana.hello(), "OK"));
  const std::string here = park("bert", local), elsewhere = park("carl", other);
  lab.bridge->hub().keep_only([](const Identity&) { return false; });
  EXPECT_FALSE(lab.bridge->hub().closing(ana.connection));
  EXPECT_CODE(ana.ask(AgentsRequest{}), "OK");
  EXPECT_TRUE(is_kept("bert", local, here));
  EXPECT_FALSE(is_kept("carl", other, elsewhere));
}

}  // namespace
}  // namespace concord::hmd

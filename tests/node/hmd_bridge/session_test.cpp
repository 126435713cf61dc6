// Who is in, as whom, and what a client may do.

#include "bridge_test.hpp"

namespace concord::hmd {
namespace {

TEST_F(Bridge, HelloAnswersWithRoleAndLimits) {
  const Json answer = ana.hello()["answer"];
  EXPECT_EQ(answer["role"], "robot");
  EXPECT_EQ(answer["resolution"], 0.1);
  EXPECT_FALSE(answer["session"].get<std::string>().empty());
  EXPECT_TRUE(ana.events.contains("agents"));
}

TEST_F(Bridge, HelloRefusesAnotherVersion) {
  HelloRequest hello;
  hello.version = "hmd.v0";
  EXPECT_CODE(ana.ask(hello), "VERSION");
  EXPECT_TRUE(lab.bridge->hub().closing(ana.connection));
}

TEST_F(Bridge, FromElsewhereATicketIsNeededAndOpensOnce) {
  HelloRequest hello;
  hello.version = kProtocol;
  Client nobody(lab, {"10.0.0.7", false});
  EXPECT_CODE(nobody.ask(hello), "BAD_TOKEN");
  hello.ticket = lab.gate->issue({"bert", Role::kView}, lab.bus->now());
  Client bert(lab, {"10.0.0.7", false});
  const Json answer = bert.ask(hello);
  EXPECT_CODE(answer, "OK");
  EXPECT_EQ(answer["answer"]["name"], "bert");
  Client again(lab, {"10.0.0.7", false});
  EXPECT_CODE(again.ask(hello), "BAD_TOKEN");
}

TEST_F(Bridge, WhoOnlyLooksCannotChange) {
  HelloRequest hello;
  hello.version = kProtocol;
  hello.ticket = lab.gate->issue({"bert", Role::kView}, lab.bus->now());
  Client bert(lab, {"10.0.0.7", false});
  EXPECT_CODE(bert.ask(hello), "OK");
  EXPECT_CODE(bert.ask(AgentsRequest{}), "OK");
  EXPECT_CODE(bert.ask(add(box(1, 1, 0.2, 1.5, 1.5, 0.5))), "DENIED");
  hello.ticket = lab.gate->issue({"cleo", Role::kEdit}, lab.bus->now());
  Client cleo(lab, {"10.0.0.7", false});
  EXPECT_CODE(cleo.ask(hello), "OK");
  EXPECT_CODE(cleo.ask(GoalRequest{"robot1", Frame::kMap, kHere}), "DENIED");
}

TEST_F(Bridge, WhoseTokenIsTakenAwayIsOutForGood) {
  HelloRequest hello;
  hello.version = kProtocol;
  hello.ticket = lab.gate->issue({"bert", Role::kEdit}, lab.bus->now());
  Client bert(lab, {"10.0.0.7", false});
  const Json first = bert.ask(hello);
  ASSERT_TRUE(has_code(first, "OK"));
  ASSERT_TRUE(has_code(ana.hello(), "OK"));
  lab.bridge->hub().keep_only([](const Identity& who) { return who.name == "bert" && who.role == Role::kEdit; });
  EXPECT_FALSE(lab.bridge->hub().closing(bert.connection));
  lab.bridge->hub().keep_only([](const Identity&) { return false; });
  EXPECT_EQ(lab.bridge->hub().closing(bert.connection)->code, 1008);
  EXPECT_FALSE(lab.bridge->hub().closing(ana.connection)) << "this machine needs none";
  bert.lose();
  hello.ticket = lab.gate->issue({"bert", Role::kEdit}, lab.bus->now());
  hello.resume = Resume{first["answer"]["session"], "", 0};
  Client back(lab, {"10.0.0.7", false});
  EXPECT_FALSE(back.ask(hello)["answer"]["resumed"].get<bool>()) << "by another token of this name, may be";
}

TEST_F(Bridge, WithoutHelloNothingGoes) {
  lab.bridge->hub().text(ana.connection, request_text(1, AgentsRequest{}), lab.bus->now());
  ana.read();
  EXPECT_EQ(lab.bridge->hub().closing(ana.connection)->code, 1002);
  Client idle(lab);
  lab.run(6);
  EXPECT_EQ(lab.bridge->hub().closing(idle.connection)->code, 1008) << "no hello within 5 s";
}

/// A refusal quotes what was sent, cut short: never within a character.
TEST_F(Bridge, WhatIsQuotedOfLongNamesIsTextStill) {
  const std::string name = std::string(39, 'a') + "é";
  const auto request = [&](std::int64_t id) {
    return R"({"id":)" + std::to_string(id) + R"(,"request":")" + name + R"(","body":{}})";
  };
  const auto greeting = [&](const std::string& body) {
    return R"({"id":1,"request":"hello","body":{"version":"hmd.v1","device":"test",)" + body + "}}";
  };
  for (const std::string& text :
       {request(1), R"({"notice":")" + name + R"(","body":{}})", greeting("\"" + name + "\":1")}) {
    Client stranger(lab, {"203.0.113.9", false});
    lab.bridge->hub().text(stranger.connection, text, lab.bus->now());
    stranger.read();
    EXPECT_TRUE(lab.bridge->hub().closing(stranger.connection)) << text;
  }
  EXPECT_CODE(ana.hello(), "OK");
  EXPECT_CODE(ana.ask_text(2, request(2)), "BAD_MESSAGE");
}

TEST_F(Bridge, RepeatsOfOneRequestHaveARateToo) {
  EXPECT_CODE(ana.hello(), "OK");
  EXPECT_CODE(ana.ask(AgentsRequest{}), "OK");
  const std::string again = request_text(ana.last_id(), AgentsRequest{});
  for (int i = 0; i < 3000; ++i) lab.bridge->hub().text(ana.connection, again, lab.bus->now());
  EXPECT_EQ(lab.bridge->hub().closing(ana.connection)->code, 1008);
}

TEST_F(Bridge, RequestsThatWalkOverTheMapCountAsTen) {
  EXPECT_CODE(ana.hello(), "OK");
  place_robot();
  lab.run(10);
  int answered = 0;
  for (std::int64_t id = 100; id < 130; ++id)
    lab.bridge->hub().text(ana.connection, request_text(id, GridRequest{{0.1, 0.8}}), lab.bus->now());
  ana.read();
  for (std::int64_t id = 100; id < 130; ++id) answered += code_of_answer(ana.answers[id]) == "OK" ? 1 : 0;
  EXPECT_EQ(answered, 10);
}

TEST_F(Bridge, TextHasABoundInBytesAsWell) {
  EXPECT_CODE(ana.hello(), "OK");
  const std::string large = R"({"notice":"credit","body":{"bytes":1}})" + std::string(900'000, ' ');
  for (int i = 0; i < 8; ++i) lab.bridge->hub().text(ana.connection, large, lab.bus->now());
  EXPECT_FALSE(lab.bridge->hub().closing(ana.connection));
  lab.bridge->hub().text(ana.connection, large, lab.bus->now());
  EXPECT_EQ(lab.bridge->hub().closing(ana.connection)->code, 1008);
}

TEST_F(Bridge, WhoSaysNoHelloTakesNobodysPlace) {
  Hub& hub = lab.bridge->hub();
  for (int i = 0; i < 200; ++i) (void)hub.open({"10.0." + std::to_string(i) + ".1", false}, lab.bus->now());
  EXPECT_TRUE(hub.open({"127.0.0.1", true}, lab.bus->now())) << "who is on this machine gets in";
  lab.run(6);
  for (const Hub::Connection connection : hub.take_ready()) {
    if (hub.closing(connection)) hub.closed(connection, lab.bus->now());
  }
  int in = 0;
  for (int i = 0; i < 20; ++i) in += hub.open({"2001:db8::" + std::to_string(i + 1), false}, lab.bus->now()) ? 1 : 0;
  EXPECT_EQ(in, 8) << "of one network";
}

TEST_F(Bridge, WhoIsRefusedOrCutOffIsALineOfTheAudit) {
  Hub& hub = lab.bridge->hub();
  const auto lines = [&] { return lab.counters.get("refused.client"); };
  hub.text(ana.connection, request_text(1, AgentsRequest{}), lab.bus->now());
  EXPECT_EQ(lines(), 1) << "no hello";
  Client late(lab), bert(lab);
  EXPECT_CODE(bert.hello(), "OK");
  lab.run(6);
  EXPECT_EQ(lines(), 2) << "a late hello";
  hub.text(bert.connection, "{", lab.bus->now());
  EXPECT_EQ(lines(), 3) << "unreadable";
}

TEST_F(Bridge, AStrangerCannotTakeUpASession) {
  const Json first = ana.hello()["answer"];
  HelloRequest hello;
  hello.version = kProtocol;
  hello.name = "eve";
  hello.resume = Resume{first["session"], "", 0};
  Client eve(lab);
  EXPECT_FALSE(eve.ask(hello)["answer"]["resumed"].get<bool>());
}

TEST_F(Bridge, NoClientCanPassForARobot) {
  lab.site.agents["cart"].kind = "robot";
  lab.site.agents["glasses"].kind = "headset";
  HelloRequest hello;
  hello.version = kProtocol;
  hello.agent = "cart";
  hello.frame_id = "odom";
  hello.ticket = lab.gate->issue({"ana", Role::kEdit}, lab.bus->now());
  EXPECT_CODE(Client(lab).ask(hello), "DENIED") << "the site file has it as a robot";
  EXPECT_CODE(Client(lab).hello("cart"), "OK") << "whose role is robot may send one";
  EXPECT_CODE(Client(lab).hello("glasses"), "OK");
  EXPECT_CODE(Client(lab).hello("robot2"), "OK") << "nobody has said anything of it";
  lab.robot_maps();
  EXPECT_CODE(Client(lab).hello("robot1", "odom"), "DENIED") << "its own process sends its map";
  lab.bus->publish("in/walker/pose", encode(AgentPose{"walker", "odom", Transform::Identity(), lab.bus->now()}));
  lab.run(0.1);
  EXPECT_CODE(Client(lab).hello("walker", "odom"), "DENIED") << "its own process says where it is";
}

TEST_F(Bridge, AHeadsetThatComesBackIsItsAgentAgain) {
  become_agent(ana, "quest", false);
  EXPECT_CODE(ana.upload(FrameKind::kMesh, 1, 0, mesh_payload(floor_look())), "OK");
  lab.run(3);
  ana.lose();
  Client back(lab);
  EXPECT_CODE(back.hello("quest"), "OK") << "it is this bridge that speaks for it";
}

TEST_F(Bridge, PlacesAreKeptForWhoSitsAtThisMachine) {
  lab.site.bridge.max_clients = 8;
  lab.restart_bridge();
  const auto from_elsewhere = [&](int i) {
    HelloRequest hello;
    hello.version = kProtocol;
    hello.ticket = lab.gate->issue({"remote" + std::to_string(i), Role::kView}, lab.bus->now());
    return hello;
  };
  std::vector<Client> remote;
  for (int i = 0; i < 6; ++i) {
    remote.emplace_back(lab, Peer{"10.0.0." + std::to_string(i), false});
    EXPECT_CODE(remote.back().ask(from_elsewhere(i)), "OK");
  }
  EXPECT_FALSE(lab.bridge->hub().open({"10.0.0.9", false}, lab.bus->now())) << "the rest is not theirs";
  Client first(lab), second(lab);
  EXPECT_CODE(first.hello(), "OK");
  EXPECT_CODE(second.hello(), "OK");
  EXPECT_FALSE(lab.bridge->hub().open({"127.0.0.1", true}, lab.bus->now()));
}

TEST_F(Bridge, ClockTellsWhenItArrived) {
  EXPECT_CODE(ana.hello(), "OK");
  const Json answer = ana.ask(ClockRequest{12.5})["answer"];
  EXPECT_EQ(answer["t0"], 12.5);
  EXPECT_GE(answer["t2"], answer["t1"]);
}

TEST_F(Bridge, IdsCountUpAndMalformedRequestsReachTheirAsker) {
  EXPECT_CODE(ana.hello(), "OK");
  EXPECT_CODE(ana.ask_text(5, R"({"id":5,"request":"agents","body":{}})"), "OK");
  EXPECT_CODE(ana.ask_text(3, R"({"id":3,"request":"agents","body":{}})"), "BAD_REQUEST");
  EXPECT_CODE(ana.ask_text(6, R"({"id":6,"request":"agents","body":{"more":1}})"), "BAD_MESSAGE");
  EXPECT_CODE(ana.ask_text(7, R"({"id":7,"request":"agents","body":{}})"), "OK");
}

TEST(BridgeAlone, SixtyFourRequestsMayWaitAndNoMore) {
  Lab lab(Lab::kWithoutMerge);
  Client ana(lab);
  EXPECT_CODE(ana.hello(), "OK");
  for (std::int64_t id = 10; id < 75; ++id) {
    lab.bridge->hub().text(ana.connection, request_text(id, UndoRequest{"edit"}), lab.bus->now());
  }
  ana.read();
  ASSERT_EQ(ana.answers.size(), 2u) << "hello, and the one too many";
  EXPECT_CODE(ana.answers[74], "BUSY");
}

TEST_F(Bridge, RequestsBeyondTheRateAreRefusedAndAFloodIsCutOff) {
  EXPECT_CODE(ana.hello(), "OK");
  int rate = 0;
  for (std::int64_t id = 10; id < 400; ++id)
    lab.bridge->hub().text(ana.connection, request_text(id, AgentsRequest{}), lab.bus->now());
  ana.read();
  for (const auto& [id, answer] : ana.answers) rate += code_of_answer(answer) == "RATE" ? 1 : 0;
  EXPECT_GT(rate, 50);
  EXPECT_EQ(lab.bridge->hub().closing(ana.connection)->code, 1008);
}

TEST_F(Bridge, WhileTrackingIsLostTheOwnFrameIsRefused) {
  become_agent(ana, "quest", true);
  EXPECT_CODE(ana.ask(ViewRequest{Layer::kMap, {}, Frame::kOwn, {0, 0, 0}, {10}, {}}), "OK");
  ana.note(TrackingNotice{Tracking::kLost, {}, {}, {}});
  EXPECT_CODE(ana.ask(ViewRequest{Layer::kMap, {}, Frame::kOwn, {0, 0, 0}, {10}, {}}), "TRACKING_LOST");
  ana.note(TrackingNotice{Tracking::kOk, "local1", kHere, {}});
  EXPECT_CODE(ana.ask(ViewRequest{Layer::kMap, {}, Frame::kOwn, {0, 0, 0}, {10}, {}}), "OK");
  ana.note(TrackingNotice{Tracking::kOk, "local2", kHere, {}});
  EXPECT_CODE(ana.ask(ViewRequest{Layer::kMap, {}, Frame::kOwn, {0, 0, 0}, {10}, {}}), "UNALIGNED");
}

TEST_F(Bridge, OthersSeeWhereOneIs) {
  become_agent(ana, "quest", true);
  Client bert(lab);
  EXPECT_CODE(bert.hello(), "OK");
  ana.note(TrackingNotice{Tracking::kOk, "local1", Pose{{0, 2, 1}, {0, 0, 0, 1}}, std::array<double, 3>{0, 0, 0}});
  lab.run(0.3);
  bert.read();
  const Json people = bert.events["people"]["people"];
  ASSERT_EQ(people.size(), 1u);
  EXPECT_EQ(people[0]["T_map_head"]["position"], Json({1.0, 2.0, 1.0}));
  EXPECT_EQ(people[0]["p_map_pointer"], Json({1.0, 0.0, 0.0}));
}

TEST(BridgeAlone, WhatNobodyAnswersIsATimeout) {
  Lab lab(Lab::kWithoutMerge);
  Client ana(lab);
  EXPECT_CODE(ana.hello(), "OK");
  EXPECT_CODE(ana.ask(add(box(1, 1, 0.2, 1.5, 1.5, 0.5))), "TIMEOUT");
}

}  // namespace
}  // namespace concord::hmd

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <limits>

#include "allocation_count.hpp"
#include "bus/lockstep_bus.hpp"
#include "message_checks.hpp"
#include "message_samples.hpp"

namespace concord::test {
namespace {

/// Reads whatever it is; taking far more memory than came in is a failure.
Decoded<Bytes> read_within_bounds(const MessageSample& sample, const Bytes& bytes) {
  const std::size_t before = bytes_allocated();
  Decoded<Bytes> read = sample.reread(bytes);
  EXPECT_LE(bytes_allocated() - before, 8192 + 40 * bytes.size()) << sample.type;
  return read;
}

TEST(Messages, come_back_as_they_were) {
  for (const MessageSample& sample : message_samples()) {
    const auto read = sample.reread(sample.bytes);
    ASSERT_TRUE(read) << sample.type << ": " << read.error().error.message;
    EXPECT_EQ(*read, sample.bytes) << sample.type;
  }
}

TEST(Messages, that_end_early_or_late_are_refused) {
  for (const MessageSample& sample : message_samples()) {
    for (std::size_t size = 0; size <= sample.bytes.size() + 9; ++size) {
      if (size == sample.bytes.size()) continue;
      Bytes bytes = sample.bytes;
      bytes.resize(size);
      const auto read = read_within_bounds(sample, bytes);
      ASSERT_FALSE(read) << sample.type << " of " << size << " bytes";
      EXPECT_EQ(read.error().error.code, Code::kMalformed) << sample.type;
    }
  }
}

TEST(Messages, of_another_type_are_refused) {
  for (const MessageSample& sample : message_samples()) {
    for (const MessageSample& other : message_samples()) {
      if (sample.type == other.type) continue;
      const auto read = sample.reread(other.bytes);
      ASSERT_FALSE(read) << other.type << " as " << sample.type;
      EXPECT_EQ(read.error().error.code, Code::kMalformed);
    }
  }
}

TEST(Messages, with_hostile_lengths_are_refused_before_memory_is_taken) {
  for (const MessageSample& sample : message_samples()) {
    for (std::size_t at = 8; at + 4 <= sample.bytes.size(); ++at) {
      for (const std::uint32_t hostile : {0x7FFFFFFFu, 0xFFFFFFFFu, 0x80000000u, 0u, 0x01000000u}) {
        Bytes bytes = sample.bytes;
        for (int i = 0; i < 4; ++i) bytes[at + i] = static_cast<std::uint8_t>(hostile >> (24 - 8 * i));
        (void)read_within_bounds(sample, bytes);
      }
    }
  }
}

RC_GTEST_PROP(MessagesProperty, damaged_bytes_are_read_whole_or_refused, ()) {
  const MessageSample& sample = *rc::gen::elementOf(message_samples());
  Bytes bytes = sample.bytes;
  const auto damages = *rc::gen::inRange(1, 5);
  for (int i = 0; i < damages; ++i) {
    bytes[*rc::gen::inRange<std::size_t>(8, bytes.size())] = *rc::gen::arbitrary<std::uint8_t>();
  }
  const auto read = read_within_bounds(sample, bytes);
  // Booleans other than 1, quaternions not quite of length 1 and boxes that overlap come back tidied.
  if (read) RC_ASSERT(sample.reread(*read).has_value());
}

TEST(Messages, bad_transforms_are_refused_to_their_asker) {
  TransformRequest request{"r", "me", "robot1", "", Transform::Identity()};
  request.T_map_agent.translation().x() = kNaN;
  expect_refused(decode<TransformRequest>(encode(request, 1)), Code::kNotFinite, "r");
  request.T_map_agent.translation().x() = 1e5;
  expect_refused(decode<TransformRequest>(encode(request, 1)), Code::kBadTransform, "r");
  request.T_map_agent = Transform::Identity();
  request.agent = "../etc";
  expect_refused(decode<TransformRequest>(encode(request, 1)), Code::kBadName, "r");
  request.agent = "robot1";
  request.frame_id = "a/b";
  expect_refused(decode<TransformRequest>(encode(request, 1)), Code::kBadFrame, "r");
  request.frame_id.clear();
  request.author = "line\nbreak";
  expect_refused(decode<TransformRequest>(encode(request, 1)), Code::kBadRequest, "r");
  request.author.clear();
  EXPECT_TRUE(decode<TransformRequest>(encode(request, 1)));
  request.id = "";
  expect_refused(decode<TransformRequest>(encode(request, 1)), Code::kBadRequest, "");
  request.id = "a\x1b[2J";
  expect_refused(decode<TransformRequest>(encode(request, 1)), Code::kBadRequest, "");
}

TEST(Messages, texts_that_are_not_utf8_are_refused) {
  for (const char* bad :
       {"\xff", "\xc3", "\xc0\xaf", "\xed\xa0\x80", "\xf5\x80\x80\x80", "\xe2\x82", "\x80", "\xf0\x80\x80\xaf"}) {
    expect_refused(decode<Answer>(encode(Answer{"r", "merge", true, "OK", bad, 0, 0}, 1)), Code::kMalformed, "");
  }
  for (const char* good : {"", "plain", "Zoë", "€", "𝕏", "\xef\xbf\xbd"}) {
    EXPECT_TRUE(decode<Answer>(encode(Answer{"r", "merge", true, "OK", good, 0, 0}, 1))) << good;
  }
}

TEST(Messages, texts_with_a_zero_inside_are_refused) {
  Bytes bytes = encode(Answer{"r", "merge", true, "OK", "text", 0, 0}, 1);
  const std::string text = "text";
  const auto at = std::search(bytes.begin(), bytes.end(), text.begin(), text.end());
  ASSERT_NE(at, bytes.end());
  at[1] = 0;
  expect_refused(decode<Answer>(bytes), Code::kMalformed, "");
}

TEST(Messages, long_texts_for_people_are_cut_between_characters) {
  std::string message = "x";
  while (message.size() < 1000) message += "€";
  const auto read = decode<Answer>(encode(Answer{"r", "merge", true, "OK", message, 0, 0}, 1));
  ASSERT_TRUE(read);
  EXPECT_EQ(read->message, message.substr(0, 400));
}

TEST(Messages, paths_are_checked) {
  PathRequest request;
  request.id = "r";
  request.robot = "robot1";
  request.goal = {kNaN, 0};
  request.radius = 0.4;
  request.keep_active = true;
  expect_refused(decode<PathRequest>(encode(request, 1)), Code::kNotFinite, "r");
  request.goal = {1, 1};
  request.start = Eigen::Vector2d(0, 1e9);
  expect_refused(decode<PathRequest>(encode(request, 1)), Code::kNotFinite, "r");
  request.start.reset();
  request.radius = kNaN;
  expect_refused(decode<PathRequest>(encode(request, 1)), Code::kBadRequest, "r");
  Path path;
  path.length = kNaN;
  expect_refused(decode<Path>(encode(path)), Code::kNotFinite, "");
  path = {};
  path.points = {{0, kNaN, 0}};
  expect_refused(decode<Path>(encode(path)), Code::kNotFinite, "");
}

TEST(Messages, map_requests_are_checked) {
  MapRequest request{"r", MapRequest::Op::kSave, "../../etc/passwd", {"bt"}, false, ""};
  expect_refused(decode<MapRequest>(encode(request, 1)), Code::kBadName, "r");
  request.map = "hall";
  using Formats = std::vector<std::string>;
  for (const Formats& none : {Formats{"sh"}, Formats{}, Formats{"bt", ""}, Formats{"bt", "ot", "bt"}}) {
    request.formats = none;
    expect_refused(decode<MapRequest>(encode(request, 1)), Code::kBadRequest, "r");
  }
  request.formats = {"concord", "bt", "ot"};
  EXPECT_TRUE(decode<MapRequest>(encode(request, 1)));
  request.op = MapRequest::Op::kLoad;
  expect_refused(decode<MapRequest>(encode(request, 1)), Code::kBadRequest, "r");
  request.formats = {};
  EXPECT_TRUE(decode<MapRequest>(encode(request, 1)));
  request.agent = "no agent";
  expect_refused(decode<MapRequest>(encode(request, 1)), Code::kBadName, "r");
}

TEST(Messages, clouds_and_octomaps_are_checked) {
  CloudMessage cloud{1, 7, 0, "odom", std::nullopt, 0, {{1, 2, 3}}};
  EXPECT_TRUE(decode<CloudMessage>(encode(cloud)));
  cloud.points[0].x() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(decode<CloudMessage>(encode(cloud)));  // what a sensor sends where it saw nothing
  cloud.max_range = kNaN;
  expect_refused(decode<CloudMessage>(encode(cloud)), Code::kBadRequest, "");
  cloud.max_range = 0;
  cloud.sequence = -1;
  expect_refused(decode<CloudMessage>(encode(cloud)), Code::kBadRequest, "");
  cloud.sequence = 0;
  cloud.boot_id = 0;
  expect_refused(decode<CloudMessage>(encode(cloud)), Code::kBadRequest, "");
  cloud.boot_id = 7;
  cloud.points.resize(2'000'001);
  expect_refused(decode<CloudMessage>(encode(cloud)), Code::kTooLarge, "");
  OctomapMessage map{1, "odom", kNaN, true, {1}};
  expect_refused(decode<OctomapMessage>(encode(map)), Code::kBadResolution, "");
  map.resolution = 0.1;
  map.frame_id = "a b";
  expect_refused(decode<OctomapMessage>(encode(map)), Code::kBadFrame, "");
}

TEST(Messages, of_a_stream_are_checked) {
  const BrickPacket good{1, 17, "map", 0.05, 3, 9, 0, {}};
  const auto refused = [&](auto change) {
    BrickPacket packet = good;
    change(packet);
    return !decode<BrickPacket>(encode(packet));
  };
  EXPECT_FALSE(refused([](BrickPacket&) {}));
  EXPECT_TRUE(refused([](BrickPacket& p) { p.boot_id = 0; }));
  EXPECT_TRUE(refused([](BrickPacket& p) { p.first_version = 0; }));
  EXPECT_TRUE(refused([](BrickPacket& p) { p.first_version = 10; }));
  EXPECT_TRUE(refused([](BrickPacket& p) { p.last_version = INT64_MAX; }));
  EXPECT_TRUE(refused([](BrickPacket& p) { p.count = -1; }));
  EXPECT_TRUE(refused([](BrickPacket& p) { p.resolution = kNaN; }));
  EXPECT_TRUE(refused([](BrickPacket& p) { p.frame_id = ""; }));
  EXPECT_TRUE(refused([](BrickPacket& p) { p.data.resize(60'001); }));
  Bytes damaged = encode(BrickPacket{1, 17, "map", 0.05, 3, 9, 1, {1, 2, 3}});
  damaged.back() ^= 1;
  expect_refused(decode<BrickPacket>(damaged), Code::kMalformed, "");

  EXPECT_TRUE(decode<BrickDigest>(encode(BrickDigest{1, 17, "", 0.05, 0, 0, 0})));
  EXPECT_FALSE(decode<BrickDigest>(encode(BrickDigest{1, 17, "map", 0.05, 1, 2, 0})));
  EXPECT_FALSE(decode<BrickDigest>(encode(BrickDigest{1, 17, "map", 0.05, INT64_MAX, 2, 0})));
  EXPECT_FALSE(decode<BrickRequest>(encode(BrickRequest{17, {{5, 4}}}, 1)));
  EXPECT_FALSE(decode<BrickRequest>(encode(BrickRequest{17, {{1, INT64_MAX}}}, 1)));
}

TEST(Messages, listen_hands_on_what_is_good_and_refuses_the_rest_to_its_asker) {
  LockstepBus bus(0);
  Counters counters;
  std::vector<AgentRequest> heard;
  std::vector<Answer> answers;
  listen<AgentRequest>(bus, counters, "ingest", "in/agent_request",
                       [&](const std::string&, const AgentRequest& request) { heard.push_back(request); });
  listen<Answer>(bus, counters, "test", kAnswers, [&](const std::string&, const Answer& a) { answers.push_back(a); });
  bus.publish("in/agent_request", encode(AgentRequest{"r1", "robot1", AgentRequest::Op::kReset}, 1));
  bus.publish("in/agent_request", encode(AgentRequest{"r2", "", AgentRequest::Op::kReset}, 1));
  bus.publish("in/agent_request", Bytes{1, 2, 3});
  bus.deliver();
  ASSERT_EQ(heard.size(), 1U);
  ASSERT_EQ(answers.size(), 1U);
  EXPECT_EQ(answers[0].id, "r2");
  EXPECT_EQ(answers[0].process, "ingest");
  EXPECT_EQ(answers[0].code, "BAD_NAME");
  EXPECT_FALSE(answers[0].ok);
  EXPECT_EQ(counters.get("refused.in/agent_request.MALFORMED"), 1);
}

/// Only notes how many messages may wait.
class QueueSpy final : public Bus {
 public:
  void subscribe(const std::string& channel, Handler /*handler*/, int queued, Owner /*owner*/) override {
    queued_[channel] = queued;
  }
  void publish(const std::string& /*channel*/, std::span<const std::uint8_t> /*bytes*/) override {}
  void every(std::int64_t /*period*/, Task /*task*/, Owner /*owner*/) override {}
  [[nodiscard]] std::int64_t now() const override { return 0; }

  std::map<std::string, int> queued_;
};

TEST(Messages, of_the_largest_kinds_only_a_few_may_wait) {
  QueueSpy bus;
  Counters counters;
  listen<BrickPacket>(bus, counters, "test", "bricks", [](const std::string&, const BrickPacket&) {});
  listen<OctomapMessage>(bus, counters, "test", "octomap", [](const std::string&, const OctomapMessage&) {});
  listen<CloudMessage>(bus, counters, "test", "cloud", [](const std::string&, const CloudMessage&) {});
  EXPECT_EQ(bus.queued_, (std::map<std::string, int>{{"bricks", Bus::kQueued}, {"octomap", 4}, {"cloud", 32}}));
}

}  // namespace
}  // namespace concord::test

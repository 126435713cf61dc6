#include "bus/list_stream.hpp"

#include <gtest/gtest.h>

#include <memory>

#include "lossy_bus.hpp"
#include "message_checks.hpp"

namespace concord::test {
namespace {

constexpr std::int64_t kSecond = 1'000'000;
const std::string kList = "out/zones";
const ListChannels kChannels(kList);

Zone zone(int number, std::size_t corners = 4) {
  Zone out;
  out.name = "zone " + std::to_string(1000 + number);
  Prism prism{{}, 0, 2};
  for (std::size_t i = 0; i < corners; ++i) {
    const double angle = 6.283185307179586 * static_cast<double>(i) / static_cast<double>(corners);
    prism.points.emplace_back(number + std::cos(angle), std::sin(angle));
  }
  out.volume = prism;
  // A rotation, which is not quite the same after a trip through a quaternion.
  out.T_map_zone.linear() = Eigen::AngleAxisd(0.1 * number, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  out.author = "Zoë";
  out.revision = number;
  return out;
}

std::vector<Zone> zones(int count, std::size_t corners = 4, int first = 0) {
  std::vector<Zone> out;
  for (int i = 0; i < count; ++i) out.push_back(zone(first + i, corners));
  return out;
}

std::vector<std::string> names(const std::vector<Zone>& list) {
  std::vector<std::string> out;
  for (const Zone& one : list) out.push_back(one.name + " " + std::to_string(one.revision));
  return out;
}

/// Someone who keeps a copy.
struct Copy {
  Copy(LockstepBus& air, Link link, std::uint64_t seed)
      : bus(air, link, seed), receiver(bus, counters, kList, [this](const std::vector<Zone>&) { ++changes; }) {}

  int changes = 0;
  Counters counters;
  LossyBus bus;
  ListReceiver<Zone> receiver;
};

class ListStream : public ::testing::Test {
 protected:
  void restart_sender() {
    sender_.reset();
    station_ = std::make_unique<LossyBus>(air_, link_, ++seed_);
    sender_ = std::make_unique<ListSender<Zone>>(*station_, counters_, kList, 5e6);
  }
  Copy& join() { return *copies_.emplace_back(std::make_unique<Copy>(air_, link_, ++seed_)); }
  void run(std::int64_t microseconds) { air_.advance_to(air_.now() + microseconds); }
  bool settled(const std::vector<Zone>& list) const {
    return std::ranges::all_of(copies_, [&](const auto& copy) {
      return copy->receiver.synced() && names(copy->receiver.items()) == names(list);
    });
  }
  /// The time until all copies are the list, or -1.
  std::int64_t settle(const std::vector<Zone>& list, std::int64_t most = 20 * kSecond) {
    const std::int64_t begin = air_.now();
    while (!settled(list)) {
      if (air_.now() - begin > most) return -1;
      run(10'000);
    }
    return air_.now() - begin;
  }
  /// How many messages go by on a channel from now on.
  std::shared_ptr<int> count(const std::string& channel) {
    auto counted = std::make_shared<int>(0);
    air_.subscribe(channel, [counted](const std::string&, auto) { ++*counted; });
    return counted;
  }

  Link link_;
  std::uint64_t seed_ = 0;
  LockstepBus air_{1'000'000 * kSecond};
  Counters counters_;
  std::unique_ptr<LossyBus> station_;
  std::unique_ptr<ListSender<Zone>> sender_;
  std::vector<std::unique_ptr<Copy>> copies_;
};

TEST_F(ListStream, IsHandedOnWholeAndOnceWhenItChanges) {
  restart_sender();
  Copy& copy = join();
  run(2 * kSecond);
  EXPECT_FALSE(copy.receiver.synced()) << "nobody has said what the list is";
  const auto parts = count(kChannels.parts), needs = count(kChannels.need);
  sender_->set(zones(200));
  ASSERT_GE(settle(zones(200), 50'000), 0);
  EXPECT_EQ(copy.changes, 1);
  EXPECT_EQ(*parts, 67);
  sender_->set(zones(200));
  run(5 * kSecond);
  EXPECT_EQ(copy.changes, 1) << "it is as it was";
  sender_->set(zones(199));
  ASSERT_GE(settle(zones(199), 50'000), 0);
  EXPECT_EQ(copy.changes, 2);
  EXPECT_EQ(*needs, 0);
  EXPECT_EQ(copy.counters.get("refused.out/zones.MALFORMED"), 0);
}

TEST_F(ListStream, CarriesZonesAsTheyAre) {
  restart_sender();
  Copy& copy = join();
  const Zone sent = zone(7, kMaxVolumePoints);
  sender_->set({sent});
  ASSERT_GE(settle({sent}), 0);
  const Zone& kept = copy.receiver.items()[0];
  EXPECT_TRUE(kept.T_map_zone.isApprox(sent.T_map_zone, 1e-12));
  EXPECT_EQ(std::get<Prism>(kept.volume).points, std::get<Prism>(sent.volume).points);
  EXPECT_EQ(kept.author, sent.author);
  EXPECT_EQ(kept.kind, sent.kind);
}

TEST_F(ListStream, OfNothingIsKnownFromItsDigest) {
  restart_sender();
  Copy& copy = join();
  sender_->set({});
  ASSERT_GE(settle({}, 20'000), 0);
  EXPECT_EQ(copy.changes, 1) << "now it is known that there are none";
  sender_->set(zones(3));
  ASSERT_GE(settle(zones(3)), 0);
  sender_->set({});
  ASSERT_GE(settle({}), 0);
  EXPECT_EQ(copy.changes, 3);
}

TEST_F(ListStream, PartsFitAFrameUnlessOneItemAloneDoesNot) {
  restart_sender();
  std::size_t longest = 0;
  air_.subscribe(kList, [&](const std::string&, auto bytes) { longest = std::max(longest, bytes.size()); });
  sender_->set(zones(300));
  run(kSecond);
  EXPECT_GT(longest, 800U);
  EXPECT_LE(longest, 1300U);
  sender_->set({zone(1, kMaxVolumePoints)});
  run(kSecond);
  EXPECT_LT(longest, 2'000U);
}

TEST_F(ListStream, ReachesWhoComesLate) {
  restart_sender();
  sender_->set(zones(100));
  run(10 * kSecond);
  Copy& copy = join();
  const std::int64_t took = settle(zones(100));
  ASSERT_GE(took, 0);
  EXPECT_LT(took, 1'500'000) << "a digest, a quiet while, one pass";
  EXPECT_EQ(copy.changes, 1);
}

TEST_F(ListStream, OfARestartedSenderCostsNothingIfItIsAsItWas) {
  restart_sender();
  Copy& copy = join();
  sender_->set(zones(100));
  ASSERT_GE(settle(zones(100)), 0);
  restart_sender();
  sender_->set(zones(100));
  run(3 * kSecond);
  EXPECT_TRUE(copy.receiver.synced());
  EXPECT_EQ(copy.changes, 1);
  restart_sender();
  sender_->set(zones(50));
  ASSERT_GE(settle(zones(50)), 0);
  EXPECT_EQ(copy.changes, 2);
}

TEST_F(ListStream, AsksAgainEverMoreSeldomWhileNobodyAnswers) {
  Copy& copy = join();
  air_.publish(kChannels.digest, encode(ListDigest{5, 3}, air_.now()));
  const auto needs = count(kChannels.need);
  run(60 * kSecond);
  EXPECT_GE(*needs, 40);
  EXPECT_LE(*needs, 60);
  EXPECT_FALSE(copy.receiver.synced());
}

TEST_F(ListStream, IsSentOnceToManyThatAsk) {
  restart_sender();
  sender_->set(zones(100));
  run(kSecond / 2);
  const auto parts = count(kChannels.parts);
  sender_->set(zones(101));
  run(kSecond / 4);
  const int pass = *parts;
  for (int i = 0; i < 10; ++i) {
    air_.publish(kChannels.need, encode(ListRequest{0}, air_.now()));
    run(20'000);
  }
  run(kSecond / 2);
  EXPECT_EQ(*parts, pass) << "asked for a list that is not";
  for (int i = 0; i < 10; ++i) join();
  ASSERT_GE(settle(zones(101)), 0);
  EXPECT_LE(*parts, 3 * pass);
}

class LossyListStream : public ListStream, public ::testing::WithParamInterface<Link> {};

TEST_P(LossyListStream, ReachesAllWhateverTheLinkDoes) {
  link_ = GetParam();
  restart_sender();
  for (int i = 0; i < 3; ++i) join();
  std::vector<Zone> list;
  for (int round = 0; round < 20; ++round) {
    list = zones(40 * (round % 5), 4 + round, round);
    sender_->set(list);
    run(round % 3 * 200'000);
    if (round == 7) join();
    if (round == 13) {
      restart_sender();
      sender_->set(list);
    }
  }
  ASSERT_GE(settle(list, 60 * kSecond), 0);
  run(5 * kSecond);
  EXPECT_TRUE(settled(list)) << "and stays";
  for (const auto& copy : copies_) EXPECT_EQ(copy->counters.get("refused.out/zones.MALFORMED"), 0);
}

INSTANTIATE_TEST_SUITE_P(Links, LossyListStream,
                         ::testing::Values(Link{}, Link{20, 0, 0}, Link{0, 50, 0}, Link{0, 0, 50}, Link{20, 20, 30},
                                           Link{50, 10, 10}));

/// Someone who says what he likes.
class HostileListStream : public ListStream {
 protected:
  HostileListStream() {
    restart_sender();
    join();
    sender_->set(zones(5));
    EXPECT_GE(settle(zones(5)), 0);
  }
  void say(const ListPart<Zone>& part) { air_.publish(kChannels.parts, encode(part, air_.now())); }
  void say(const ListDigest& digest) { air_.publish(kChannels.digest, encode(digest, air_.now())); }
  Copy& copy() { return *copies_[0]; }
  std::int64_t refused(const std::string& channel, const char* code) {
    return copy().counters.get("refused." + channel + "." + code);
  }
};

TEST_F(HostileListStream, PartsOfAnotherListAreNotHeeded) {
  say(ListPart<Zone>{99, 0, 1, zones(1), {}});
  run(100'000);
  EXPECT_EQ(copy().changes, 1);
  EXPECT_TRUE(settled(zones(5)));
}

TEST_F(HostileListStream, AListThatIsNotWhatItsDigestSaysIsNeverShown) {
  say(ListDigest{99, 2});
  say(ListPart<Zone>{99, 0, 2, zones(1), {}});
  say(ListPart<Zone>{99, 1, 2, zones(1), {}});
  say(ListPart<Zone>{99, 1, 3, zones(1), {}});
  run(10'000);
  EXPECT_EQ(refused(kChannels.parts, "MALFORMED"), 1);
  EXPECT_EQ(copy().changes, 1);
  EXPECT_FALSE(copy().receiver.synced());
  EXPECT_EQ(copy().receiver.items().size(), 5U) << "the one before stays";
  say(ListDigest{77, 0});
  run(10'000);
  EXPECT_EQ(copy().receiver.items().size(), 5U);
  ASSERT_GE(settle(zones(5), kSecond + 100'000), 0) << "the next digest puts it right";
  EXPECT_EQ(copy().changes, 1);
}

TEST_F(HostileListStream, AForgedPartIsThrownOutWithTheListItSpoils) {
  ListDigest announced;
  air_.subscribe(kChannels.digest,
                 [&](const std::string&, auto bytes) { announced = decode<ListDigest>(bytes).value(); });
  copy().bus.subscribe(kChannels.digest, [&](const std::string&, auto) {
    if (announced.parts == 2) {
      const auto number = static_cast<std::int32_t>(announced.parts - 1);
      say(ListPart<Zone>{announced.content, number, announced.parts, zones(1, 4, 500), {}});
      announced.parts = 0;
    }
  });
  sender_->set(zones(6));
  run(20'000);
  EXPECT_EQ(refused(kChannels.parts, "MALFORMED"), 1);
  EXPECT_EQ(copy().changes, 1);
  ASSERT_GE(settle(zones(6), kSecond), 0) << "it asks for the list again";
  EXPECT_EQ(copy().changes, 2);
}

TEST_F(HostileListStream, NoMoreIsKeptThanAListMayHold) {
  say(ListDigest{99, 1000});
  run(1'000);
  for (int part = 0; part < 100; ++part) say(ListPart<Zone>{99, part, 1000, zones(64), {}});
  run(1'000);
  EXPECT_EQ(refused(kChannels.parts, "TOO_LARGE"), 100 - 1000 / 64);
  ASSERT_GE(settle(zones(5)), 0);
  ListReceiver<Lease> leases(air_, counters_, "out/leases", [](const std::vector<Lease>&) {});
  air_.publish("out/leases/digest", encode(ListDigest{99, 65}, 1));
  run(1'000);
  EXPECT_EQ(counters_.get("refused.out/leases/digest.TOO_LARGE"), 1);
}

TEST_F(HostileListStream, BytesThatAreNoMessageAreCounted) {
  for (const auto& channel : {kChannels.parts, kChannels.digest, kChannels.need}) {
    air_.publish(channel, Bytes{1, 2, 3});
  }
  run(10'000);
  EXPECT_EQ(refused(kChannels.parts, "MALFORMED"), 1);
  EXPECT_EQ(refused(kChannels.digest, "MALFORMED"), 1);
  EXPECT_EQ(counters_.get("refused.out/zones/need.MALFORMED"), 1);
  EXPECT_TRUE(settled(zones(5)));
}

TEST_F(HostileListStream, RequestsAreAnsweredWithinThePace) {
  const auto parts = count(kChannels.parts);
  ListDigest digest;
  air_.subscribe(kChannels.digest, [&](const std::string&, auto bytes) { digest = *decode<ListDigest>(bytes); });
  run(kSecond);
  const int before = *parts;
  for (int i = 0; i < 1000; ++i) {
    air_.publish(kChannels.need, encode(ListRequest{digest.content}, air_.now()));
    run(1'000);
  }
  EXPECT_LE(*parts - before, 13 * digest.parts) << "they are gathered for 80 ms";
}

}  // namespace
}  // namespace concord::test

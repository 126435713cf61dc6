#include <memory>
#include <vector>

#include "core/brick.hpp"
#include "noise.hpp"
#include "station.hpp"
#include "system_test.hpp"

// The brick stream between hosts, over real UDP multicast. What counts: every copy ends equal to its source, to the
// byte.

namespace concord::test {
namespace {

constexpr double kResolution = 0.05;
constexpr int kLossPerMille = 50;
const std::string kStream = "in/robot1";

bool is_copied(StreamSource& source, const StreamCopy& copy) {
  return copy.synced() && copy.receiver().revision() == source.sender().revision() && copy.map() == source.map();
}

class StreamSystemTest : public SystemTest {
 protected:
  void SetUp() override {
    SystemTest::SetUp();
    if (IsSkipped()) return;
    source_ = std::make_unique<StreamSource>(network().add("robot"), kStream, kResolution, noisy_map(48, 1));
  }

  StreamCopy& add_copy(const Host& host) {
    return *copies_.emplace_back(std::make_unique<StreamCopy>(host, kStream, kResolution));
  }
  [[nodiscard]] bool all_copied() {
    std::vector<LcmBus*> buses = {&source_->bus()};
    for (const auto& copy : copies_) buses.push_back(&copy->bus());
    return eventually(buses, [&] {
      for (const auto& copy : copies_) {
        if (!is_copied(*source_, *copy)) return false;
      }
      return true;
    });
  }

  std::unique_ptr<StreamSource> source_;
  std::vector<std::unique_ptr<StreamCopy>> copies_;
};

TEST_F(StreamSystemTest, one_packet_in_twenty_lost_everywhere) {
  std::vector<Host*> hosts;
  for (const char* name : {"laptop", "headset", "planner"}) {
    hosts.push_back(&network().add(name));
    hosts.back()->lose_arriving(kLossPerMille);
    add_copy(*hosts.back());
  }
  ASSERT_TRUE(all_copied());

  std::uint32_t seed = 7;
  for (int x = 0; x < 24; ++x) source_->set({x, 3, 0}, Brick::from_dense(noise(seed)));
  source_->set({30, 3, 0}, Brick());
  ASSERT_TRUE(all_copied());
  for (const Host* host : hosts) EXPECT_GT(host->lost(), 20) << host->name();
}

TEST_F(StreamSystemTest, requests_for_repair_are_lost_too) {
  Host& robot = network().add("robot2");
  robot.lose_arriving(kLossPerMille);
  source_.reset();
  source_ = std::make_unique<StreamSource>(robot, kStream, kResolution, noisy_map(32, 2));
  Host& laptop = network().add("laptop");
  laptop.lose_arriving(4 * kLossPerMille);
  add_copy(laptop);
  EXPECT_TRUE(all_copied());
}

TEST_F(StreamSystemTest, a_late_joiner_gets_all) {
  ASSERT_TRUE(eventually({&source_->bus()}, [&] { return source_->sender().idle(); }));
  add_copy(network().add("laptop"));
  EXPECT_TRUE(all_copied());
}

TEST_F(StreamSystemTest, a_restarted_source_is_copied_without_what_it_lost) {
  Host& robot = network().add("robot2");
  add_copy(network().add("laptop"));
  ASSERT_TRUE(all_copied());
  source_.reset();
  source_ = std::make_unique<StreamSource>(robot, kStream, kResolution, noisy_map(20, 3));
  EXPECT_TRUE(all_copied());
}

}  // namespace
}  // namespace concord::test

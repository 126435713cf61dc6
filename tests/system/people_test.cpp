#include <gtest/gtest.h>

#include "soak.hpp"
#include "system_test.hpp"

// A short soak each: `./run soak` is the long one.

namespace concord::test {
namespace {

std::string words(const soak::Outcome& outcome) {
  std::string all;
  for (const std::string& complaint : outcome.complaints) all += complaint + "\n";
  return all;
}

class PeopleSystemTest : public SystemTest {};

TEST_F(PeopleSystemTest, eight_people_edit_at_once_over_a_lossy_network_and_see_the_same) {
  const soak::Outcome outcome = soak::run({.operations = 400, .kills = 0, .loss_per_mille = 50, .seed = 11}, network());
  EXPECT_GT(outcome.acknowledged, 100);
  EXPECT_TRUE(outcome.good()) << words(outcome);
}

TEST_F(PeopleSystemTest, what_was_acknowledged_outlives_processes_killed_at_any_moment) {
  const soak::Outcome outcome = soak::run({.operations = 200, .kills = 12, .seed = 12}, network());
  EXPECT_GT(outcome.acknowledged, 50);
  EXPECT_TRUE(outcome.good()) << words(outcome);
}

}  // namespace
}  // namespace concord::test

#include "cli/demo_watch.hpp"

#include <gtest/gtest.h>

namespace concord {
namespace {

ProcessStatus ingest(std::int64_t boot_id, std::map<std::string, std::int64_t> counters) {
  return {boot_id + 1, "ingest", boot_id, std::move(counters)};
}

TEST(LostClouds, AreSummedOverTheStartsOfIngest) {
  LostClouds lost;
  EXPECT_EQ(lost.of("cart1"), 0);
  lost.note(ingest(100, {{"gaps.cart1", 3}, {"known.cart1", 50}}));
  lost.note(ingest(100, {{"gaps.cart1", 5}, {"gaps.cart2", 1}}));
  lost.note(ingest(200, {{"known.cart1", 70}}));
  lost.note(ingest(200, {{"gaps.cart1", 2}}));
  EXPECT_EQ(lost.of("cart1"), 7);
  EXPECT_EQ(lost.of("cart2"), 1);
  EXPECT_EQ(lost.of("cart"), 0);
}

}  // namespace
}  // namespace concord

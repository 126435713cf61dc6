#include <cstdlib>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "core/decimal.hpp"

namespace concord {
namespace {

TEST(Decimal, IsAsShortAsItCanBe) {
  EXPECT_EQ(decimal(0.05), "0.05");
  EXPECT_EQ(decimal(1), "1");
  EXPECT_EQ(decimal(-0.1), "-0.1");
}

RC_GTEST_PROP(Decimal, ReadsBackTheSame, (double value)) {
  RC_ASSERT(std::strtod(decimal(value).c_str(), nullptr) == value);
}

}  // namespace
}  // namespace concord

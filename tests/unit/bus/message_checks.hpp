#pragma once

#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "bus/messages.hpp"

namespace concord::test {

inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Expects a refusal with this code that reaches the asker.
template <class T>
void expect_refused(const Decoded<T>& read, Code code, const std::string& id) {
  ASSERT_FALSE(read);
  EXPECT_EQ(name(read.error().error.code), std::string(name(code)));
  EXPECT_EQ(read.error().id, id);
}

}  // namespace concord::test

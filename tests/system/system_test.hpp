#pragma once

#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "network.hpp"

namespace concord::test {

/// Why there is no private network; empty: there is one.
extern std::string refusal_of_network;

/// A test on a network of its own; skipped in words where namespaces are not permitted (loss, late joiners and restarts
/// are then still tested in process, in tests/node).
class SystemTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!refusal_of_network.empty()) {
      GTEST_SKIP() << "network namespaces are not permitted here: " << refusal_of_network;
    }
    network_ = std::make_unique<Network>();
  }
  [[nodiscard]] Network& network() { return *network_; }

 private:
  std::unique_ptr<Network> network_;
};

}  // namespace concord::test

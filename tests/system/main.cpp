#include <gtest/gtest.h>

#include "system_test.hpp"

std::string concord::test::refusal_of_network;

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  concord::test::refusal_of_network = concord::test::enter_private_network();
  return RUN_ALL_TESTS();
}

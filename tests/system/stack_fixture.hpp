#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "bus/messages.hpp"
#include "stack.hpp"
#include "station.hpp"
#include "system_test.hpp"

namespace concord::test {

/// A stack that has not been started, and a person who hears which agents there are.
class StackFixture : public SystemTest {
 protected:
  void SetUp() override {
    SystemTest::SetUp();
    if (IsSkipped()) return;
    stack_ = std::make_unique<Stack>(network());
    person_ = &network().add("person");
    ear_ = std::make_unique<Station>(*person_);
    person_->inside([this] {
      listen<AgentList>(ear_->bus(), ear_->counters(), "test", "out/agents",
                        [this](const std::string&, AgentList list) { agents_ = std::move(list.agents); });
    });
  }
  void TearDown() override {
    if (stack_ && HasFailure()) ADD_FAILURE() << stack_->logs();
  }

  std::unique_ptr<Stack> stack_;
  Host* person_ = nullptr;
  std::unique_ptr<Station> ear_;
  std::vector<AgentState> agents_;
};

}  // namespace concord::test

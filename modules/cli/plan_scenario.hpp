#pragma once

#include <string>

#include "cli/command.hpp"
#include "planner/scenario/scenario.hpp"

namespace concord {

struct ScenarioOptions {
  std::string map, scenario;  ///< files
  std::string paths;          ///< to write, one JSON object a line; empty: none
  Method method = Method::kFast;
};

/// `concord plan --map M.map --scen S.scen`: asks all queries and prints what came of it. README.md has the keys.
[[nodiscard]] Outcome plan_scenario(const ScenarioOptions& options, const Common& common);

}  // namespace concord

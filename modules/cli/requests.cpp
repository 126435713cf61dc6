// What people ask about agents: one request, one answer.

#include <memory>

#include "cli/arguments.hpp"
#include "cli/live.hpp"
#include "cli/report.hpp"

namespace concord {
namespace {

struct Placing {
  std::string agent, transform, frame, author;
};

Outcome set_transform(const Placing& placing, const Common& common) {
  if (!is_name(placing.agent)) return bad_name(placing.agent);
  const auto T_map_agent = parse_transform(placing.transform);
  if (!T_map_agent) return fail(T_map_agent.error());
  Live live(common);
  const TransformRequest request{live.new_id(), author_or_user(placing.author), placing.agent, placing.frame,
                                 *T_map_agent};
  return print_revision(live.ask("in/transform", request), common);
}

void add_agent_request(Program& program, const std::string& name, const std::string& what, AgentRequest::Op op) {
  auto agent = std::make_shared<std::string>();
  program
      .add(name, what,
           [agent, op](const Common& common) -> Outcome {
             if (!is_name(*agent)) return bad_name(*agent);
             Live live(common);
             const AgentRequest request{live.new_id(), *agent, op};
             return print_answer(live.ask("in/agent_request", request), common);
           })
      .add_option("agent", *agent, "the agent's id")
      ->required();
}

}  // namespace

void add_requests(Program& program) {
  auto placing = std::make_shared<Placing>();
  CLI::App& align = program.add("set-transform", "puts an agent's submap into the map",
                                [placing](const Common& common) { return set_transform(*placing, common); });
  align.add_option("agent", placing->agent, "the agent's id")->required();
  align.add_option("transform", placing->transform, "T_map_agent as \"x y z qx qy qz qw\"")->required();
  align.add_option("--frame", placing->frame, "the agent's frame it was found for; without it the present one");
  align.add_option("--author", placing->author, "who asks; without it $USER");

  add_agent_request(program, "reset", "drops what an agent sent; it begins anew", AgentRequest::Op::kReset);
  add_agent_request(program, "remove", "forgets an agent and what it sent", AgentRequest::Op::kRemove);
}

}  // namespace concord

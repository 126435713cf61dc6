// What people know better about an agent: how much it counts, and where a robot was.

#include <charconv>
#include <memory>

#include "cli/arguments.hpp"
#include "cli/live.hpp"
#include "cli/report.hpp"
#include "cli/times.hpp"

namespace concord {
namespace {

struct Weighing {
  std::string agent, author, id;
  int weight = 1;
};

struct Sighting {
  std::string robot, pose, at = "now", author, id;
  WorkFrame frame;
};

Outcome set_weight(const Weighing& weighing, const Common& common) {
  if (!is_name(weighing.agent)) return bad_name(weighing.agent);
  if (const auto fine = check_own_id(weighing.id); !fine) return fail(fine.error());
  Live live(common);
  const WeightRequest request{live.id_or_new(weighing.id), author_or_user(weighing.author), weighing.agent,
                              weighing.weight, live.bus().now()};
  return print_revision(live.ask("in/weight", request), common);
}

/// Microseconds since 1970, or what every other time is given as.
Result<std::int64_t> parse_utime(const std::string& text, std::int64_t now) {
  std::int64_t utime = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), utime);
  if (error == std::errc() && end == text.data() + text.size() && utime > 0) return utime;
  return parse_time(text, now);
}

tl::expected<std::int64_t, Failure> time_given(const std::string& text, Live& live) {
  const auto utime = parse_utime(text, live.bus().now());
  if (!utime) return fail(utime.error());
  return *utime;
}

/// When the robot says where it is next: of a time after its last pose nobody knows yet where it was.
tl::expected<std::int64_t, Failure> time_of_next_pose(Live& live, const std::string& robot) {
  const auto utime = std::make_shared<std::optional<std::int64_t>>();  // the subscription outlives this call
  live.hear<AgentPose>("in/" + robot + "/pose",
                       [utime](const std::string&, const AgentPose& pose) { *utime = pose.utime; });
  if (live.wait(live.timeout(), [&] { return utime->has_value(); })) return **utime;
  return fail(Exit::kNoAnswer, "NO_ANSWER", "nothing is heard of where " + robot + " is; say when it was seen: --at");
}

Outcome localise(const Sighting& sighting, const Common& common) {
  if (const auto fine = check_own_id(sighting.id); !fine) return fail(fine.error());
  for (const std::string& name : {sighting.frame.agent, sighting.frame.frame_id}) {
    if (!name.empty() && !is_name(name)) return bad_name(name);
  }
  if (!is_name(sighting.robot)) return bad_name(sighting.robot);
  const auto T_frame_base = parse_transform(sighting.pose);
  if (!T_frame_base) return fail(T_frame_base.error());
  Live live(common);
  const auto utime = sighting.at == "now" ? time_of_next_pose(live, sighting.robot) : time_given(sighting.at, live);
  if (!utime) return tl::unexpected(utime.error());
  const LocaliseRequest request{live.id_or_new(sighting.id),
                                author_or_user(sighting.author),
                                sighting.robot,
                                *T_frame_base,
                                sighting.frame,
                                *utime};
  return print_revision(live.ask("in/localise", request), common);
}

}  // namespace

void add_agent_corrections(Program& program) {
  auto weighing = std::make_shared<Weighing>();
  CLI::App& weigh = program.add("set-weight", "gives an agent another weight than the site file's, for good",
                                [weighing](const Common& common) { return set_weight(*weighing, common); });
  weigh.add_option("agent", weighing->agent, "the agent's id")->required();
  weigh.add_option("weight", weighing->weight, "1 to 1000")->required()->check(CLI::Range(1, 1000));

  auto sighting = std::make_shared<Sighting>();
  CLI::App& locate = program.add("localise", "a robot was seen: places its submap so that it was there",
                                 [sighting](const Common& common) { return localise(*sighting, common); });
  locate.add_option("robot", sighting->robot, "its id")->required();
  locate.add_option("pose", sighting->pose, "its base as \"x y z qx qy qz qw\"")->required();
  locate
      .add_option("--at", sighting->at,
                  "when, within the last 30 s: now (the robot's next pose), 2026-11-22T07:15:03.5 (local; or with Z, "
                  "+01:00), 5s (ago), or microseconds since 1970")
      ->capture_default_str();
  locate.add_option("--frame", sighting->frame.agent, "the agent in whose frame it was seen; without it the map's");
  locate.add_option("--frame-id", sighting->frame.frame_id,
                    "that agent's frame as it was seen: refused if it has begun another since");
  for (const auto& [command, author, id] :
       {std::tuple(&weigh, &weighing->author, &weighing->id), std::tuple(&locate, &sighting->author, &sighting->id)}) {
    command->add_option("--author", *author, "who asks; without it $USER");
    command->add_option("--id", *id, "of this request: asked again with it, it is done once");
  }
}

}  // namespace concord

#include "cli/plan_footprint.hpp"

#include <chrono>

#include <nlohmann/json.hpp>

#include "cli/map_file.hpp"
#include "cli/numbers.hpp"
#include "cli/outlines.hpp"
#include "planner/footprint/footprint_text.hpp"
#include "planner/pose_plan.hpp"

namespace concord {
namespace {

using Clock = std::chrono::steady_clock;

/// No search that is bounded as it should be takes so long: when this fires there is a fault, not a result.
constexpr std::chrono::seconds kWatchdog{120};
/// Between the outlines that the picture shows, in footprint lengths.
constexpr double kOutlines = 0.5;

struct Asked {
  Pose from, to;
  Footprint footprint;
};

Result<Asked> parse(const FootprintOptions& options) {
  const auto from = read_pose(options.from);
  if (!from) return tl::unexpected(from.error());
  const auto to = read_pose(options.to);
  if (!to) return tl::unexpected(to.error());
  return read_footprint(options.footprint).map([&](Footprint footprint) {
    return Asked{*from, *to, std::move(footprint)};
  });
}

double milliseconds(Clock::duration time) { return std::chrono::duration<double, std::milli>(time).count(); }

nlohmann::json numbers(const Pose& pose) { return {pose.p.x(), pose.p.y(), pose.yaw}; }

nlohmann::json to_json(const PosePlan& plan, const Asked& asked, double turn_radius) {
  nlohmann::json points = nlohmann::json::array(), outline = nlohmann::json::array();
  for (const Pose& pose : plan.poses) points.push_back(numbers(pose));
  for (const Eigen::Vector2d& corner : asked.footprint.polygon()) outline.push_back({corner.x(), corner.y()});
  const bool found = plan.reason == Reason::kOk;
  return {{"status", name(plan.reason)},
          {"message", plan.message},
          {"length", found ? nlohmann::json(plan.length) : nlohmann::json()},
          {"least_clearance", found ? nlohmann::json(plan.least_clearance) : nlohmann::json()},
          {"footprint", std::move(outline)},
          {"turn_radius", turn_radius},
          {"points", std::move(points)},
          {"clearance", plan.clearance}};
}

std::string to_words(const PosePlan& plan) {
  if (plan.reason != Reason::kOk) return std::string(name(plan.reason)) + ": " + plan.message;
  return "path of " + format_number(plan.length, 2) + " m, " + std::to_string(plan.poses.size()) +
         " poses, least clearance " + format_number(plan.least_clearance, 3) + " m";
}

std::vector<Eigen::Vector2d> outline(const Footprint& footprint, const Pose& pose) {
  const Eigen::Vector2d ahead = pose.heading(), left(-ahead.y(), ahead.x());
  std::vector<Eigen::Vector2d> corners;
  for (const Eigen::Vector2d& v : footprint.polygon()) corners.push_back(pose.p + v.x() * ahead + v.y() * left);
  return corners;
}

/// Outlines along the way, straight lines between far poses too.
Outlines outlines(const Footprint& footprint, const std::vector<Pose>& poses) {
  Outlines drawn{outline(footprint, poses.front())};
  const double apart = kOutlines * 2 * footprint.circumscribed();
  double since = 0;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const Pose &a = poses[i - 1], &b = poses[i];
    const double turn = wrapped(b.yaw - a.yaw);
    const double step = (b.p - a.p).norm() + footprint.circumscribed() * std::abs(turn);
    for (since += step; since >= apart; since -= apart) {
      const double share = 1 - (since - apart) / step;
      drawn.push_back(outline(footprint, {a.p + share * (b.p - a.p), a.yaw + share * turn}));
    }
  }
  drawn.push_back(outline(footprint, poses.back()));
  return drawn;
}

Result<void> draw(const FootprintOptions& options, const Asked& asked, const Ground2D& ground, const PosePlan& plan) {
  Overview overview;
  overview.title = "Path";
  overview.subtitle = options.map + ", footprint " + options.footprint + " m, turn radius " +
                      format_number(options.turn_radius, 2) + " m: " + plan.message;
  overview.resolution = ground.grid.resolution();
  overview.cut = options.cut;
  overview.map = &ground.map;
  overview.after = Overview::Route{name(plan.reason), {}, plan.length, plan.message};
  for (const Pose& pose : plan.poses) overview.after->points.push_back(pose.p);
  overview.start = asked.from.p;
  overview.goal = asked.to.p;
  const std::vector<Pose> poses = plan.poses.empty() ? std::vector{asked.from} : plan.poses;
  return write_overview(overview, options.picture).and_then([&](const OverviewFrame& frame) {
    return draw_outlines(outlines(asked.footprint, poses), frame, options.picture);
  });
}

}  // namespace

Outcome plan_footprint(const FootprintOptions& options, const Ground2D& ground, const Common& common) {
  auto asked = parse(options);
  if (!asked) return fail(asked.error());
  const Clock::time_point begin = Clock::now();
  PosePlanner planner(ground.grid, {asked->footprint, options.turn_radius});
  planner.prepare();
  const Clock::time_point prepared = Clock::now();
  const Pose from{asked->from.p - ground.origin, asked->from.yaw}, to{asked->to.p - ground.origin, asked->to.yaw};
  PosePlan plan = planner.plan(from, to, 0, [&] { return Clock::now() - prepared > kWatchdog; });
  if (plan.stopped) {
    return fail(Exit::kNegative, "TIMEOUT", "the search took over two minutes and was stopped: report this");
  }
  const double ms = milliseconds(Clock::now() - prepared);
  if (!options.picture.empty()) {
    Asked here = *asked;
    here.from = from;
    here.to = to;
    if (const auto drawn = draw(options, here, ground, plan); !drawn) return fail(drawn.error());
  }
  for (Pose& pose : plan.poses) pose.p += ground.origin;
  if (!plan.poses.empty()) {
    plan.poses.front() = asked->from;
    plan.poses.back() = asked->to;
  }
  nlohmann::json object = to_json(plan, *asked, options.turn_radius);
  if (!options.paths.empty()) {
    nlohmann::json line = object;
    line["query"] = 0;
    if (const auto written = write_file(options.paths, line.dump() + '\n'); !written) return fail(written.error());
  }
  object["prep_ms"] = milliseconds(prepared - begin);
  object["ms"] = ms;
  common.print(object, to_words(plan));
  if (plan.reason == Reason::kBadRequest) return Exit::kUnusable;
  return plan.reason == Reason::kOk ? Exit::kDone : Exit::kNegative;
}

}  // namespace concord

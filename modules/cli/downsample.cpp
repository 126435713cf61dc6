#include "cli/downsample.hpp"

#include <algorithm>
#include <map>
#include <memory>
#include <sstream>

#include <nlohmann/json.hpp>

#include "cli/map_file.hpp"
#include "cli/numbers.hpp"
#include "cli/report.hpp"

namespace concord {
namespace {

constexpr std::int64_t kSilence = 1'000'000;  // microseconds

struct Options {
  std::string agent, out;
  double resolution = 0.5;
};

/// The parts of one answer; they may come in any order and more than once.
struct Parts {
  std::map<std::int32_t, Downsampled> heard;
  std::int64_t last_heard = 0;

  void take(Downsampled part, std::int64_t now) {
    // Asked again, the submap may have changed: what was heard before belongs to another cloud.
    if (!heard.empty() && heard.begin()->second.parts != part.parts) heard.clear();
    heard[part.part] = std::move(part);
    last_heard = now;
  }

  [[nodiscard]] bool complete() const {
    return !heard.empty() && static_cast<std::int32_t>(heard.size()) == heard.begin()->second.parts;
  }
  [[nodiscard]] std::vector<Eigen::Vector3f> points() const {
    std::vector<Eigen::Vector3f> all;
    for (const auto& [part, value] : heard) all.insert(all.end(), value.points.begin(), value.points.end());
    return all;
  }
};

std::string as_csv(const std::vector<Eigen::Vector3f>& points) {
  std::ostringstream out;
  out << "x,y,z\n";
  for (const auto& p : points) out << p.x() << ',' << p.y() << ',' << p.z() << '\n';
  return out.str();
}

std::string as_pcd(const std::vector<Eigen::Vector3f>& points) {
  std::ostringstream out;
  out << "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH " << points.size()
      << "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " << points.size() << "\nDATA ascii\n";
  for (const auto& p : points) out << p.x() << ' ' << p.y() << ' ' << p.z() << '\n';
  return out.str();
}

Outcome downsample(const Options& options, const Common& common) {
  const std::string extension = std::filesystem::path(options.out).extension();
  if (extension != ".pcd" && extension != ".csv") {
    return fail(Exit::kUnusable, "BAD_NAME", options.out + " must end in .pcd or .csv");
  }
  if (!is_name(options.agent)) return bad_name(options.agent);
  Live live(common);
  if (const double voxel = live.site().resolution; !(options.resolution >= voxel)) {
    return fail(Exit::kUnusable, name(Code::kBadResolution),
                "a cell of " + format_number(options.resolution, 3) + " m is smaller than a voxel; here these have " +
                    format_number(voxel, 3) + " m");
  }
  const auto points = request_cloud(live, {live.new_id(), options.agent, options.resolution});
  if (!points) return tl::unexpected(points.error());
  const auto written = write_file(options.out, extension == ".csv" ? as_csv(*points) : as_pcd(*points));
  if (!written) return fail(written.error());
  common.print({{"agent", options.agent}, {"resolution", options.resolution}, {"points", points->size()}},
               format_count(static_cast<std::int64_t>(points->size())) + " points written to " + options.out);
  return Exit::kDone;
}

}  // namespace

tl::expected<std::vector<Eigen::Vector3f>, Failure> request_cloud(Live& live, const DownsampleRequest& request) {
  const auto parts = std::make_shared<Parts>();  // the subscription outlives this call
  live.hear<Downsampled>("out/downsampled", [parts, id = request.id, &live](const std::string&, Downsampled part) {
    if (part.id == id) parts->take(std::move(part), live.bus().now());
  });
  const auto refused = [&] {
    const Answer* answer = live.answer_to(request.id);
    return answer != nullptr && !answer->ok;
  };
  std::int64_t asked = 0;
  live.wait(live.timeout(), [&] {
    const std::int64_t now = live.bus().now();
    if (parts->complete() || refused()) return true;
    if (now - std::max(asked, parts->last_heard) > kSilence) {
      live.bus().publish("in/downsample", encode(request, now));
      asked = now;
    }
    return false;
  });
  if (refused()) {
    const Answer& answer = *live.answer_to(request.id);
    return fail(Exit::kRefused, answer.code, answer.process + ": " + answer.message);
  }
  if (parts->heard.empty()) return live.no_answer("ingest");
  if (!parts->complete()) return fail(Exit::kIncomplete, "INCOMPLETE", "parts of the cloud did not arrive; try again");
  return parts->points();
}

void add_downsample(Program& program) {
  auto options = std::make_shared<Options>();
  CLI::App& command = program.add("downsample", "a coarse cloud of one agent's occupied voxels",
                                  [options](const Common& common) { return downsample(*options, common); });
  command.add_option("agent", options->agent, "the agent's id")->required();
  command.add_option("resolution", options->resolution, "edge of a cell, metres")->required();
  command.add_option("--out", options->out, "a .pcd or .csv file, agent's frame")->required();
}

}  // namespace concord

#include <map>
#include <memory>
#include <sstream>

#include <nlohmann/json.hpp>

#include "cli/live.hpp"
#include "cli/map_file.hpp"
#include "cli/page.hpp"

namespace concord {
namespace {

struct Options {
  std::string agent, out;
  double resolution = 0.5;
};

/// The parts of one answer; they may come in any order and more than once.
struct Parts {
  std::map<std::int32_t, Downsampled> heard;

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
  if (!is_name(options.agent)) return fail(Exit::kUnusable, "BAD_NAME", options.agent + " is no agent's id");
  Live live(common);
  const DownsampleRequest request{live.new_id(), options.agent, options.resolution};
  Parts parts;
  live.hear<Downsampled>("out/downsampled", [&](const std::string&, Downsampled part) {
    if (part.id == request.id) parts.heard[part.part] = std::move(part);
  });
  const auto refused = [&] {
    const Answer* answer = live.answer_to(request.id);
    return answer != nullptr && !answer->ok;
  };
  const auto done = [&] { return parts.complete() || refused(); };
  live.ask_until("in/downsample", encode(request, live.bus().now()), live.timeout(), done);
  if (refused()) {
    const Answer& answer = *live.answer_to(request.id);
    return fail(Exit::kRefused, answer.code, answer.process + ": " + answer.message);
  }
  if (parts.heard.empty()) return live.no_answer("ingest");
  if (!parts.complete()) return fail(Exit::kIncomplete, "INCOMPLETE", "parts of the cloud did not arrive; try again");

  const std::vector<Eigen::Vector3f> points = parts.points();
  const std::string text = extension == ".csv" ? as_csv(points) : as_pcd(points);
  const auto written = write_file(options.out, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  if (!written) return fail(written.error());
  common.print({{"agent", options.agent}, {"resolution", options.resolution}, {"points", points.size()}},
               format_count(static_cast<std::int64_t>(points.size())) + " points written to " + options.out);
  return Exit::kDone;
}

}  // namespace

void add_downsample(Program& program) {
  auto options = std::make_shared<Options>();
  CLI::App& command = program.add("downsample", "a coarse cloud of one agent's occupied voxels",
                                  [options](const Common& common) { return downsample(*options, common); });
  command.add_option("agent", options->agent, "the agent's id")->required();
  command.add_option("resolution", options->resolution, "edge of a cell, metres")->required();
  command.add_option("--out", options->out, "a .pcd or .csv file, agent's frame")->required();
}

}  // namespace concord

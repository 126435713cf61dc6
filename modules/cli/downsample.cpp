#include "cli/downsample.hpp"

#include <memory>
#include <sstream>

#include <nlohmann/json.hpp>

#include "cli/extension.hpp"
#include "cli/map_file.hpp"
#include "cli/numbers.hpp"
#include "cli/parts.hpp"
#include "cli/report.hpp"

namespace concord {
namespace {

constexpr std::int64_t kSilence = 1'000'000;  // microseconds

struct Options {
  std::string agent, out;
  double resolution = 0.5;
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
  const std::string extension = extension_of(options.out);
  if (extension != ".pcd" && extension != ".csv") {
    return fail(Exit::kUnusable, "BAD_NAME", options.out + " must end in .pcd or .csv");
  }
  if (!is_name(options.agent)) return bad_name(options.agent);
  if (!(options.resolution > 0)) {
    return fail(Exit::kUnusable, name(Code::kBadResolution),
                "a cell has a size of more than 0 m, and no less than a voxel");
  }
  Live live(common);
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
  const auto parts =
      ask_in_parts<Downsampled>(live, Respondent{"in/downsample", "ingest", "out/downsampled", kSilence}, request);
  if (!parts) return tl::unexpected(parts.error());
  std::vector<Eigen::Vector3f> points;
  for (const Downsampled& part : *parts) points.insert(points.end(), part.points.begin(), part.points.end());
  return points;
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

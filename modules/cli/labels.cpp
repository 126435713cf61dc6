// labels: asks what is labelled, and takes it to a file and back.

#include <filesystem>
#include <memory>

#include "bus/messages_label.hpp"
#include "cli/arguments.hpp"
#include "cli/label_list.hpp"
#include "cli/list_copy.hpp"
#include "cli/numbers.hpp"
#include "cli/report.hpp"
#include "cli/semantic_commands.hpp"
#include "core/voxel_boxes.hpp"
#include "semantic/labels/semantic_cloud.hpp"
#include "store/whole_file.hpp"

namespace concord {
namespace {

constexpr std::uint64_t kMostFile = 27 * kMaxCloudPoints + 1'000'000;

struct Options {
  std::string at, of_class, within, border, out, load, author;
  bool classes = false;
};

Result<LabelQuery> query_of(const Options& options) {
  LabelQuery query;
  const int given = !options.at.empty() + !options.of_class.empty() + !options.within.empty() +
                    !options.border.empty() + options.classes;
  if (given > 1) return refuse(Code::kBadRequest, "give one of --at, --class, --within and --border");
  if (options.classes) {
    query.kind = LabelQuery::Kind::kClasses;
  } else if (!options.at.empty()) {
    query.kind = LabelQuery::Kind::kAt;
    const auto p = parse_vector(options.at);
    if (!p) return tl::unexpected(p.error());
    query.p_map = *p;
  } else if (!options.within.empty()) {
    query.kind = LabelQuery::Kind::kWithin;
    const auto numbers = parse_numbers(options.within, 4);
    if (!numbers) return tl::unexpected(numbers.error());
    query.p_map = {(*numbers)[0], (*numbers)[1], (*numbers)[2]};
    query.radius = (*numbers)[3];
  } else if (!options.of_class.empty() || !options.border.empty()) {
    query.kind = options.border.empty() ? LabelQuery::Kind::kClass : LabelQuery::Kind::kBorder;
    query.name = options.border.empty() ? options.of_class : options.border;
  }
  return query;
}

bool is_pcd(const std::string& file) { return std::filesystem::path(file).extension() == ".pcd"; }

Result<void> check_name(const std::string& file) {
  if (is_pcd(file) || std::filesystem::path(file).extension() == ".ply") return {};
  return refuse(Code::kBadName, file + " must end in .pcd or .ply");
}

Outcome save(const std::string& file, Live& live, const Common& common) {
  StreamCopy map(live, "out/map"), labels(live, "out/labels");
  ListCopy<LabelSlot> slots(live, "out/label_slots");
  for (StreamCopy* copy : {&map, &labels}) {
    if (const auto synced = copy->wait_synced(live); !synced) return tl::unexpected(synced.error());
  }
  const auto all = slots.wait_synced(live);
  if (!all) return tl::unexpected(all.error());
  const SemanticCloud cloud = semantic_cloud(map.map(), labels.map(), *all, live.site().resolution);
  const auto written = write_whole_file(file, is_pcd(file) ? write_pcd(cloud) : write_ply(cloud));
  if (!written) return fail(written.error());
  const auto labelled = static_cast<std::int64_t>(labels.map().known_count());
  common.print(
      {{"points", cloud.points.size()}, {"labelled", labelled}, {"classes", cloud.classes.size()}, {"file", file}},
      format_count(static_cast<std::int64_t>(cloud.points.size())) + " points, " + format_count(labelled) +
          " of them labelled, written to " + file);
  return Exit::kDone;
}

/// Every label of the file, with its numbers, one request an instance.
Outcome load(const Options& options, Live& live, const Common& common) {
  const auto bytes = read_whole_file(options.load, kMostFile);
  if (!bytes) return fail(bytes.error());
  const auto cloud = is_pcd(options.load) ? read_pcd(*bytes) : read_ply(*bytes);
  if (!cloud) return fail({cloud.error().code, options.load + ": " + cloud.error().message});
  const auto instances = instances_of(*cloud);
  if (!instances) return fail(instances.error());
  std::int64_t voxels = 0;
  std::vector<std::string> ids;
  for (const auto& [of, own] : *instances) {
    LabelRequest request;
    request.id = live.new_id();
    request.author = author_or_user(options.author);
    request.op = LabelRequest::Op::kRestore;
    request.name = cloud->classes.at(of.label);
    request.of = of;
    request.shape = VoxelList{cloud->resolution, to_boxes(own)};
    request.utime = live.bus().now();
    const auto answer = live.ask("in/label", request);
    if (!answer) return tl::unexpected(answer.error());
    voxels += answer->count;
    ids.push_back(request.id);
  }
  common.print(
      {{"instances", instances->size()}, {"voxels", voxels}, {"ids", ids}},
      format_count(static_cast<std::int64_t>(instances->size())) + " instances, " + format_count(voxels) + " voxels" +
          (ids.empty() ? "" : "\nconcord label undo takes one back; ids " + ids.front() + " to " + ids.back()));
  return Exit::kDone;
}

Outcome labels(const Options& options, const Common& common) {
  for (const std::string& file : {options.out, options.load}) {
    if (file.empty()) continue;
    if (const auto fine = check_name(file); !fine) return fail(fine.error());
  }
  const auto query = query_of(options);
  if (!query) return fail(query.error());
  Live live(common);
  if (const auto taken = live.take_resolution(); !taken) return tl::unexpected(taken.error());
  if (!options.load.empty()) return load(options, live, common);
  if (!options.out.empty()) return save(options.out, live, common);
  const auto found = request_labels(live, *query);
  if (!found) return tl::unexpected(found.error());
  nlohmann::json all = nlohmann::json::array();
  for (const LabelInstance& one : *found) all.push_back(to_json(one, live.site().resolution));
  common.print({{"instances", all}},
               found->empty() ? "no label shows there" : to_words(*found, live.site().resolution));
  return Exit::kDone;
}

}  // namespace

void add_labels(Program& program) {
  auto options = std::make_shared<Options>();
  CLI::App& command = program.add("labels", "what is labelled, and where",
                                  [options](const Common& common) { return labels(*options, common); });
  command.add_option("--at", options->at, "\"x y z\": what is there");
  command.add_option("--class", options->of_class, "all of this class");
  command.add_option("--within", options->within, "\"x y z r\": what lies within r metres of a point");
  command.add_option("--border", options->border, "the free space that things of this class border");
  command.add_flag("--classes", options->classes, "all classes that were named");
  command.add_option("--out", options->out, "writes the map with its labels: .pcd or .ply");
  command.add_option("--load", options->load, "labels the map as such a file says, with its numbers");
  command.add_option("--author", options->author, "who loads; without it $USER");
}

}  // namespace concord

// labels --out, labels --load: takes the labels to a file and back.

#include "cli/labels_file.hpp"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <ranges>
#include <set>
#include <vector>

#include "bus/messages_label.hpp"
#include "cli/label_list.hpp"
#include "cli/list_copy.hpp"
#include "cli/numbers.hpp"
#include "cli/report.hpp"
#include "core/shape.hpp"
#include "semantic/labels/semantic_cloud.hpp"
#include "store/whole_file.hpp"

namespace concord {
namespace {

constexpr std::uint64_t kMostFile = 27 * kMaxCloudPoints + 1'000'000;
constexpr double kSettle = 0.3;  ///< seconds until a label that was made has reached us by all ways

bool is_pcd(const std::string& file) { return std::filesystem::path(file).extension() == ".pcd"; }

/// What a cloud holds of each instance, as semantic would say it.
bool is_what_shows(const SemanticCloud& cloud, const std::vector<LabelInstance>& shown) {
  const auto instances = instances_of(cloud);
  if (!instances || instances->size() != shown.size()) return false;
  return std::ranges::all_of(shown, [&](const LabelInstance& one) {
    const auto own = instances->find(one.of);
    if (own == instances->end() || static_cast<std::int64_t>(own->second.size()) != one.voxels) return false;
    VoxelIndex min = own->second.front(), max = min;
    for (const VoxelIndex v : own->second) {
      min = {std::min(min.x, v.x), std::min(min.y, v.y), std::min(min.z, v.z)};
      max = {std::max(max.x, v.x), std::max(max.y, v.y), std::max(max.z, v.z)};
    }
    return min == one.min && max == one.max && cloud.classes.at(one.of.label) == one.name;
  });
}

/// Voxels and what their numbers mean come by two streams, and after a restart of semantic the numbers mean something
/// else: what was put together of them is compared with what semantic says shows.
tl::expected<SemanticCloud, Failure> copied_cloud(Live& live) {
  StreamCopy map(live, "out/map"), labels(live, "out/labels");
  ListCopy<LabelSlot> slots(live, "semantic", "out/label_slots");
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(live.timeout());
  do {
    for (StreamCopy* copy : {&map, &labels}) {
      if (const auto synced = copy->wait_synced(live); !synced) return tl::unexpected(synced.error());
    }
    const auto all = slots.wait_synced(live);
    if (!all) return tl::unexpected(all.error());
    auto cloud = semantic_cloud(map.map(), labels.map(), *all, live.site().resolution);
    const auto shown = request_labels(live, {});
    if (!shown) return tl::unexpected(shown.error());
    if (cloud && is_what_shows(*cloud, *shown)) return std::move(*cloud);
    live.wait(kSettle, [] { return false; });
  } while (std::chrono::steady_clock::now() < end);
  return fail(Exit::kIncomplete, "INCOMPLETE",
              "the labels change all the while; try again, or give a longer --timeout");
}

/// In parts that each fit one request.
void add_parts(std::span<const VoxelIndex> voxels, double resolution, std::vector<VoxelList>& out) {
  if (static_cast<std::int64_t>(voxels.size()) <= kMaxLabelVoxels) {
    if (auto list = voxel_list(voxels, resolution)) return out.push_back(std::move(*list));
  }
  add_parts(voxels.first(voxels.size() / 2), resolution, out);
  add_parts(voxels.subspan(voxels.size() / 2), resolution, out);
}

/// One request each, checked as far as they can be before any is asked.
tl::expected<std::vector<LabelRequest>, Failure> requests_for(const SemanticCloud& cloud, const std::string& author,
                                                              Live& live) {
  const auto instances = instances_of(cloud);
  if (!instances) return fail(instances.error());
  LabelQuery classes;
  classes.kind = LabelQuery::Kind::kClasses;
  const auto here = request_labels(live, classes);
  if (!here) return tl::unexpected(here.error());
  for (const LabelInstance& one : *here) {
    const auto same_number = cloud.classes.find(one.of.label);
    const auto same_name = std::ranges::find(cloud.classes, one.name, [](const auto& entry) { return entry.second; });
    if (same_number == same_name) continue;
    return fail(Exit::kRefused, name(Code::kConflict),
                "class " + std::to_string(one.of.label) + " is " + one.name +
                    " here, and not so in the file; nothing was labelled");
  }
  std::vector<LabelRequest> out;
  for (const auto& [of, own] : *instances) {
    std::vector<VoxelList> parts;
    add_parts(own, cloud.resolution, parts);
    for (VoxelList& part : parts) {
      LabelRequest request;
      request.id = live.new_id();
      request.author = author;
      request.op = LabelRequest::Op::kRestore;
      request.name = cloud.classes.at(of.label);
      request.of = of;
      request.shape = std::move(part);
      request.utime = live.bus().now();
      out.push_back(std::move(request));
    }
  }
  return out;
}

/// The latest first. What is left of it cannot be taken back: said with why it should have been.
Failure taken_back(const std::vector<std::string>& done, const std::string& author, Live& live, Failure why) {
  for (const std::string& id : done | std::views::reverse) {
    LabelRequest undo;
    undo.id = live.new_id();
    undo.author = author;
    undo.op = LabelRequest::Op::kUndo;
    undo.correction_id = id;
    undo.utime = live.bus().now();
    const auto undone = live.ask("in/label", undo);
    if (undone || undone.error().code == name(Code::kNotFound)) continue;  // or it was never done
    why.message +=
        "; what was labelled may still be there: concord label undo takes back " + done.front() + " to " + id;
    return why;
  }
  why.message += "; nothing was labelled";
  return why;
}

}  // namespace

Result<void> check_labels_file(const std::string& file) {
  if (is_pcd(file) || std::filesystem::path(file).extension() == ".ply") return {};
  return refuse(Code::kBadName, file + " must end in .pcd or .ply");
}

Outcome save_labels(const std::string& file, Live& live, const Common& common) {
  const auto cloud = copied_cloud(live);
  if (!cloud) return tl::unexpected(cloud.error());
  const auto written = write_whole_file(file, is_pcd(file) ? write_pcd(*cloud) : write_ply(*cloud));
  if (!written) return fail(written.error());
  const auto points = static_cast<std::int64_t>(cloud->points.size());
  const auto labelled = std::ranges::count_if(cloud->points, [](const SemanticPoint& p) { return p.label != 0; });
  common.print({{"points", points}, {"labelled", labelled}, {"classes", cloud->classes.size()}, {"file", file}},
               format_count(points) + " points, " + format_count(labelled) + " of them labelled, written to " + file);
  return Exit::kDone;
}

Outcome load_labels(const std::string& file, const std::string& author, Live& live, const Common& common) {
  const auto bytes = read_whole_file(file, kMostFile);
  if (!bytes) return fail(bytes.error());
  const auto cloud = is_pcd(file) ? read_pcd(*bytes) : read_ply(*bytes);
  if (!cloud) return fail({cloud.error().code, file + ": " + cloud.error().message});
  const auto requests = requests_for(*cloud, author, live);
  if (!requests) return tl::unexpected(requests.error());
  std::int64_t voxels = 0;
  std::vector<std::string> ids;
  std::set<InstanceId> labelled;
  for (const LabelRequest& request : *requests) {
    const auto answer = live.ask("in/label", request);
    if (!answer && answer.error().code == name(Code::kEmpty)) continue;  // nothing of it is occupied here
    if (!answer) {
      ids.push_back(request.id);  // who did not answer may have done it
      return tl::unexpected(taken_back(ids, author, live, answer.error()));
    }
    voxels += answer->count;
    ids.push_back(request.id);
    labelled.insert(request.of);
  }
  const auto in_file = static_cast<std::int64_t>(instances_of(*cloud)->size());
  const auto loaded = static_cast<std::int64_t>(labelled.size());
  std::string words = format_count(loaded) + " instances, " + format_count(voxels) + " voxels";
  if (loaded < in_file) words += "; of " + format_count(in_file - loaded) + " nothing is occupied here";
  if (!ids.empty()) words += "\nconcord label undo takes one back; ids " + ids.front() + " to " + ids.back();
  common.print({{"instances", loaded}, {"voxels", voxels}, {"left_out", in_file - loaded}, {"ids", ids}}, words);
  return Exit::kDone;
}

}  // namespace concord

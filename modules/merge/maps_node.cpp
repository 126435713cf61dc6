#include "merge/maps_node.hpp"

#include <optional>
#include <utility>

#include "core/octomap_writer.hpp"
#include "merge/loaded_corrections.hpp"

namespace concord {
namespace {

const std::string kRequests = "in/map_request";
const std::string kNative = "concord";

}  // namespace

MapsNode::MapsNode(const NodeContext& context, const Parts& parts)
    : context_(context), parts_(parts), replies_(context), maps_(context.site.state / "maps"), answers_(context.bus) {
  listen<MapRequest>(context_.bus, context_.counters, context_.process, kRequests,
                     [this](const std::string&, const MapRequest& request) {
                       switch (request.op) {
                         case MapRequest::Op::kSave: return save(request);
                         case MapRequest::Op::kList: return list(request);
                         case MapRequest::Op::kLoad: return load(request);
                       }
                     });
}

void MapsNode::save(const MapRequest& request) {
  const std::uint64_t content = content_of(request);
  if (answers_.repeat(request.id, context_.process, content)) return;
  if (parts_.people_node.repeat(kRequests, request.id, content)) return;
  const auto bytes = write(request);
  if (!bytes) return replies_.deny(kRequests, request.id, bytes.error());
  const std::string file = request.map + "." + request.format;
  answers_.give(replies_.granted(request.id, parts_.map.revision(), *bytes, "saved " + file), content);
}

/// Returns the bytes written.
Result<std::int64_t> MapsNode::write(const MapRequest& request) {
  parts_.map.refold_and_send();
  if (!parts_.map.begun()) {
    return refuse(Code::kBusy, "the map is not whole again after a restart; ask again in some seconds");
  }
  if (const auto may = maps_.check(request.map, request.format, request.overwrite); !may) {
    return tl::unexpected(may.error());
  }
  const auto bytes = encoded(request.format);
  if (!bytes) return tl::unexpected(bytes.error());
  if (const auto saved = maps_.save(*bytes, request.map, request.format); !saved) return tl::unexpected(saved.error());
  return static_cast<std::int64_t>(bytes->size());
}

Result<Bytes> MapsNode::encoded(const std::string& format) {
  if (format == kNative) return archived();
  return write_octomap_file(parts_.map.layers().map(), context_.site.resolution,
                            format == "ot" ? OctomapFormat::kFull : OctomapFormat::kBinary);
}

Result<Bytes> MapsNode::archived() {
  MapArchiveWriter writer(context_.site.resolution);
  for (const auto& [id, layer] : parts_.map.layers().layers()) {
    const LayerHead head{id, context_.site.agent(id).kind, layer.frame_id, parts_.agents.incarnation(id), layer.weight};
    if (const auto added = writer.add(head, layer.map); !added) return tl::unexpected(added.error());
  }
  std::optional<Error> refused;
  const auto read = parts_.store.for_each([&](const Correction& correction) {
    if (refused) return;
    if (const auto added = writer.add(correction); !added) refused = added.error();
  });
  if (!read) return tl::unexpected(read.error());
  if (refused) return tl::unexpected(*refused);
  return std::move(writer).finish();
}

void MapsNode::list(const MapRequest& request) {
  const auto files = maps_.list();
  if (!files) return replies_.deny(kRequests, request.id, files.error());
  context_.bus.publish("out/map_list", encode(MapList{request.id, *files}, context_.bus.now()));
  replies_.grant(request.id, 0, static_cast<std::int64_t>(files->size()), "listed");
}

/// Only native maps hold anything that is merge's; ingest answers for the others.
void MapsNode::load(const MapRequest& request) {
  if (request.format != kNative && !(request.format.empty() && maps_.contains(request.map, kNative))) return;
  const std::uint64_t content = content_of(request);
  if (answers_.repeat(request.id, context_.process, content)) return;
  if (parts_.people_node.repeat(kRequests, request.id, content)) return;
  const auto taken = take(request);
  if (!taken) return replies_.deny(kRequests, request.id, taken.error());
  answers_.give(replies_.granted(request.id, parts_.people.revision(), *taken, "took over what people corrected"),
                content);
}

/// Returns how many corrections followed.
Result<std::int64_t> MapsNode::take(const MapRequest& request) {
  if (!request.agent.empty()) {
    return refuse(Code::kBadRequest, "a .concord file names its agents; leave agent empty, or load format ot or bt");
  }
  const auto file = maps_.read(request.map, kNative, kMaxArchiveBytes);
  if (!file) return tl::unexpected(file.error());
  MapArchiveOptions options;
  options.resolution = context_.site.resolution;
  options.known_voxels = static_cast<std::uint64_t>(context_.site.ingest.max_known_voxels);
  options.keep_bricks = false;
  const auto archive = read_map_archive(*file, options);
  if (!archive) return tl::unexpected(archive.error());
  const Loading loading{*archive, request.id, loaded_incarnation(*file, request.id), context_.bus.now()};
  auto ours = check_of_ours();
  if (!ours) return tl::unexpected(ours.error());
  auto corrections = corrections_to_load(loading, parts_.people, std::move(*ours),
                                         [&](const std::string& agent) { return context_.site.agent(agent).weight; });
  if (!corrections) return tl::unexpected(corrections.error());
  if (const auto there = check_layers(*archive, loading.incarnation); !there) return tl::unexpected(there.error());
  const auto count = static_cast<std::int64_t>(corrections->size());
  if (const auto done = parts_.people_node.commit(*corrections); !done) return tl::unexpected(done.error());
  return count;
}

/// Whether ingest's streams say that the file's layers are agents now, whole: before that they cannot be placed.
Result<void> MapsNode::check_layers(const MapArchive& archive, std::int64_t incarnation) const {
  for (const SavedLayer& layer : archive.layers) {
    const auto state = parts_.agents.state_of(layer.head.agent);
    if (!state || !state->synced || parts_.agents.incarnation(layer.head.agent) != incarnation) {
      return refuse(Code::kBusy, layer.head.agent + " has not been loaded yet; ask again in a second");
    }
  }
  return {};
}

Result<CorrectionCheck> MapsNode::check_of_ours() {
  CorrectionCheck check;
  std::optional<Error> refused;
  const auto read = parts_.store.for_each([&](const Correction& correction) {
    if (refused) return;
    if (const auto taken = check.take(correction); !taken) refused = taken.error();
  });
  if (!read) return tl::unexpected(read.error());
  if (refused) return tl::unexpected(*refused);
  return check;
}

}  // namespace concord

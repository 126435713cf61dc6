#include "merge/maps_node.hpp"

#include <filesystem>
#include <numeric>
#include <optional>
#include <utility>

#include "core/octomap_writer.hpp"
#include "store/handover.hpp"
#include "store/whole_file.hpp"

namespace concord {
namespace {

/// Long after a client that waits for layers would have asked again.
constexpr std::int64_t kKeepOpened = 60'000'000;
constexpr std::int64_t kForgetPeriod = 10'000'000;
/// Longer, and it does not run. Between the two a map would be saved without labels that somebody keeps.
constexpr std::int64_t kGone = 90'000'000;

std::string names_of(const MapRequest& request) {
  std::string names;
  for (const std::string& format : request.formats) {
    names += (names.empty() ? "" : ", ") + request.map + "." + format;
  }
  return names;
}

}  // namespace

MapsNode::MapsNode(const NodeContext& context, const Parts& parts)
    : context_(context),
      parts_(parts),
      replies_(context),
      maps_(context.site.state / "maps"),
      answers_(context.bus),
      start_(context.bus.now()) {
  listen<MapRequest>(context_.bus, context_.counters, context_.process, kRequests,
                     [this](const std::string&, const MapRequest& request) {
                       switch (request.op) {
                         case MapRequest::Op::kSave: return save(request);
                         case MapRequest::Op::kList: return list(request);
                         case MapRequest::Op::kLoad: return load(request);
                       }
                     });
  listen<ProcessStatus>(context_.bus, context_.counters, context_.process, "out/status/semantic",
                        [this](const std::string&, const ProcessStatus&) { semantic_heard_ = context_.bus.now(); });
  listen<Answer>(context_.bus, context_.counters, context_.process, kAnswers,
                 [this](const std::string&, const Answer& answer) {
                   if (opened_ && answer.id == opened_->request_id && answer.process == "semantic") {
                     opened_->labels = answer;
                   }
                 });
  context_.bus.every(kForgetPeriod, [this] {
    if (opened_ && context_.bus.now() - opened_->asked >= kKeepOpened) opened_.reset();
  });
}

void MapsNode::save(const MapRequest& request) {
  const std::uint64_t content = content_of(request);
  if (answers_.repeat(request.id, context_.process, content, request.utime)) return;
  if (parts_.people_node.repeat(kRequests, request.id, content)) return;
  const auto labels = labels_for(request);
  const auto files =
      labels.and_then([&](const std::optional<Bytes>& all) { return write(request, all.value_or(Bytes())); });
  if (!files) return answers_.give(replies_.denied(kRequests, request.id, files.error()), content, request.utime);
  Answer saved = replies_.granted(request.id, parts_.map.revision(), 0, "saved " + names_of(request));
  if (request.names(kNative) && !*labels) saved.message += ", without labels: semantic does not run";
  saved.content = digest(parts_.map.layers().map());
  for (const auto& [format, bytes] : *files) saved.parts.push_back(static_cast<std::int64_t>(bytes.size()));
  saved.count = std::accumulate(saved.parts.begin(), saved.parts.end(), std::int64_t{0});
  answers_.give(saved, content);
}

/// Returns what was written: all formats, or none.
Result<MapStore::Files> MapsNode::write(const MapRequest& request, const Bytes& labels) {
  if (const auto may = may_write(request); !may) return tl::unexpected(may.error());
  MapStore::Files files;
  for (const std::string& format : request.formats) {
    auto bytes = encoded(format, labels);
    if (!bytes) return tl::unexpected(bytes.error());
    files.emplace_back(format, std::move(*bytes));
  }
  if (const auto saved = maps_.save(request.map, files); !saved) return tl::unexpected(saved.error());
  return files;
}

Result<void> MapsNode::may_write(const MapRequest& request) {
  parts_.map.refold_and_send();
  if (!parts_.map.begun()) {
    return refuse(Code::kBusy, "the map is not whole again after a restart; ask again in some seconds");
  }
  if (request.names(kNative)) {
    if (const auto whole = parts_.agents.all_whole(); !whole) return tl::unexpected(whole.error());
  }
  for (const std::string& format : request.formats) {
    if (const auto may = maps_.check(request.map, format, request.overwrite); !may) return may;
  }
  return {};
}

Result<Bytes> MapsNode::encoded(const std::string& format, const Bytes& labels) {
  if (format == kNative) return archived(labels);
  return write_octomap_file(parts_.map.layers().map(), context_.site.resolution,
                            format == "ot" ? OctomapFormat::kFull : OctomapFormat::kBinary);
}

/// Nothing: another format, or semantic does not run. It lays them there for each such request that it hears, and hears
/// it when we do.
Result<std::optional<Bytes>> MapsNode::labels_for(const MapRequest& request) const {
  if (!request.names(kNative)) return std::nullopt;
  const std::int64_t silent = context_.bus.now() - semantic_heard_.value_or(start_);
  std::error_code error;
  const bool has_run = semantic_heard_ || std::filesystem::exists(context_.site.state / "semantic.db", error);
  if (silent > (has_run ? kGone : kSemanticSilence)) return std::nullopt;
  if (silent > kSemanticSilence) {
    return refuse(Code::kBusy, "semantic, which keeps the labels, has said nothing for " +
                                   std::to_string(silent / 1'000'000) +
                                   " s; ask again (without a word of it for 90 s the map is saved without labels)");
  }
  if (!semantic_heard_) return refuse(Code::kBusy, "merge has just begun; ask again in some seconds");
  auto labels = read_whole_file(handover_file(context_.site.state, request.id), kMaxArchiveBytes);
  if (labels) return std::optional(std::move(*labels));
  if (labels.error().code != Code::kNotFound) return tl::unexpected(labels.error());
  return refuse(Code::kBusy, "the labels are being handed over; ask again");
}

Result<Bytes> MapsNode::archived(const Bytes& labels) {
  MapArchiveWriter writer(context_.site.resolution);
  for (const auto& [id, layer] : parts_.map.layers().layers()) {
    const LayerHead head{id, context_.site.agent(id).kind, layer.frame_id, parts_.agents.incarnation(id), layer.weight};
    if (const auto added = writer.add(head, layer.map); !added) return tl::unexpected(added.error());
  }
  const auto read = parts_.store.for_each([&](const Correction& correction) { return writer.add(correction); });
  if (!read) return tl::unexpected(read.error());
  if (!labels.empty()) writer.add_labels(labels);
  return std::move(writer).finish();
}

void MapsNode::list(const MapRequest& request) {
  const auto files = maps_.list();
  if (!files) return replies_.deny(kRequests, request.id, files.error());
  context_.bus.publish("out/map_list", encode(MapList{request.id, *files}, context_.bus.now()));
  replies_.grant(request.id, 0, static_cast<std::int64_t>(files->size()), "listed");
}

}  // namespace concord

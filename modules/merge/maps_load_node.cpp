// The part of MapsNode that loads native maps, together with ingest: map_archive.md says who does what when.

#include <algorithm>
#include <set>
#include <utility>

#include "merge/loaded_corrections.hpp"
#include "merge/maps_node.hpp"
#include "merge/spent_corrections.hpp"

namespace concord {

/// Only native maps hold anything that is merge's; ingest answers for the others.
void MapsNode::load(const MapRequest& request) {
  if (!request.names(kNative) && !(request.formats.empty() && maps_.contains(request.map, kNative))) return;
  const std::uint64_t content = content_of(request);
  if (answers_.repeat(request.id, context_.process, content, request.utime)) return;
  if (parts_.people_node.repeat(kRequests, request.id, content)) return;
  advance(request, content);
}

/// Nothing that could refuse the file is left for when its layers have been loaded.
void MapsNode::advance(const MapRequest& request, std::uint64_t content) {
  const auto deny = [&](const Error& why) {
    answers_.give(replies_.denied(kRequests, request.id, why), content, request.utime);
  };
  if (const auto opened = open(request, content); !opened) return deny(opened.error());
  const bool has_all = has_layers();
  if (has_all || opened_->fits_at != parts_.people.revision()) {
    const auto corrections = following();
    if (!corrections) return deny(corrections.error());
    opened_->fits_at = parts_.people.revision();
    if (has_all) return take_over(request, *corrections, content);
  }
  if (const auto may = labels_may_load(); !may) return deny(may.error());
  say_may_load(request);
}

void MapsNode::take_over(const MapRequest& request, const std::vector<Correction>& corrections, std::uint64_t content) {
  if (const auto done = parts_.people_node.commit(corrections); !done) {
    return answers_.give(replies_.denied(kRequests, request.id, done.error()), content, request.utime);
  }
  opened_.reset();
  answers_.give(replies_.granted(request.id, parts_.people.revision(), static_cast<std::int64_t>(corrections.size()),
                                 "took over what people corrected"),
                content);
}

Result<void> MapsNode::open(const MapRequest& request, std::uint64_t content) {
  if (!request.agent.empty()) {
    return refuse(Code::kBadRequest, "a .concord file names its agents; leave agent empty, or load format ot or bt");
  }
  const auto version = maps_.version(request.map, kNative);
  if (!version) return tl::unexpected(version.error());
  const bool is_open = opened_ && opened_->request_id == request.id && opened_->content == content;
  if (!is_open || opened_->version != *version) {
    opened_.reset();
    const auto file = maps_.read(request.map, kNative, kMaxArchiveBytes);
    if (!file) return tl::unexpected(file.error());
    MapArchiveOptions options;
    options.resolution = context_.site.resolution;
    options.known_voxels = static_cast<std::uint64_t>(context_.site.ingest.max_known_voxels);
    options.keep_bricks = false;
    auto archive = read_map_archive(*file, options);
    if (!archive) return tl::unexpected(archive.error());
    opened_ = Opened{};
    Opened& opened = *opened_;
    opened.request_id = request.id;
    opened.content = content;
    opened.version = *version;
    opened.incarnation = loaded_incarnation(*file, request.id);
    opened.archive = std::move(*archive);
  }
  opened_->asked = context_.bus.now();
  return {};
}

/// The file's corrections, as they follow on ours. @pre opened_.
Result<std::vector<Correction>> MapsNode::following() {
  if (const auto taken = take_ours(); !taken) return tl::unexpected(taken.error());
  MapArchive without;
  const std::set<std::string> spent = spent_corrections(opened_->archive.corrections, parts_.people);
  if (!spent.empty()) {
    without = opened_->archive;
    std::erase_if(without.corrections, [&](const Correction& correction) { return spent.contains(correction.id); });
  }
  const Loading loading{spent.empty() ? opened_->archive : without, opened_->request_id, opened_->incarnation,
                        context_.bus.now()};
  return corrections_to_load(loading, parts_.people, opened_->ours,
                             [&](const std::string& agent) { return context_.site.agent(agent).weight; });
}

/// Those that were made since the last time. @pre opened_.
Result<void> MapsNode::take_ours() {
  return parts_.store.for_each(
      [&](const Correction& correction) {
        auto taken = opened_->ours.take(correction);
        if (taken) opened_->ours_revision = correction.revision;
        return taken;
      },
      opened_->ours_revision);
}

/// Whether ingest's streams say that the file's layers are agents now, whole: before that they cannot be placed.
/// @pre opened_.
bool MapsNode::has_layers() const {
  return std::ranges::all_of(opened_->archive.layers, [&](const SavedLayer& layer) {
    const auto state = parts_.agents.state_of(layer.head.agent);
    return state && state->synced && parts_.agents.incarnation(layer.head.agent) == opened_->incarnation;
  });
}

/// What semantic refuses must not have been loaded by half. Where it does not run there is nothing to wait for. @pre
/// opened_.
Result<void> MapsNode::labels_may_load() const {
  if (!semantic_heard_ || context_.bus.now() - *semantic_heard_ > kSemanticSilence) return {};
  if (!opened_->labels) {
    return refuse(Code::kBusy, "semantic has not looked at its labels yet; ask again in a second");
  }
  if (opened_->labels->ok || opened_->labels->code == name(Code::kBusy)) return {};
  return refuse(Code::kConflict, "its labels cannot be taken over: " + opened_->labels->message);
}

/// Ingest listens for this. The revision names the very file that was checked, and the request. @pre opened_.
void MapsNode::say_may_load(const MapRequest& request) {
  answer(context_.bus,
         {request.id, context_.process, false, name(Code::kBusy),
          "the map may be loaded; its layers are not all here yet, ask again in a second", opened_->incarnation, 0});
}

}  // namespace concord

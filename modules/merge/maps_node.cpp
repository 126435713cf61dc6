#include "merge/maps_node.hpp"

namespace concord {
namespace {

const std::string kRequests = "in/map_request";

}  // namespace

MapsNode::MapsNode(const NodeContext& context, MapStreams& map, PeopleNode& people)
    : context_(context),
      map_(map),
      people_(people),
      replies_(context),
      maps_(context.site.state / "maps"),
      answers_(context.bus) {
  listen<MapRequest>(context_.bus, context_.counters, context_.process, kRequests,
                     [this](const std::string&, const MapRequest& request) {
                       if (request.op == MapRequest::Op::kSave) save(request);
                       if (request.op == MapRequest::Op::kList) list(request);
                     });
}

void MapsNode::save(const MapRequest& request) {
  const std::uint64_t content = content_of(request);
  if (answers_.repeat(request.id, context_.process, content)) return;
  if (people_.repeat(kRequests, request.id, content)) return;
  map_.refold_and_send();
  if (!map_.begun()) {
    return replies_.deny(kRequests, request.id,
                         {Code::kBusy, "the map is not whole again after a restart; ask again in some seconds"});
  }
  const auto bytes =
      maps_.save(map_.layers().map(), context_.site.resolution, request.map, request.format, request.overwrite);
  if (!bytes) return replies_.deny(kRequests, request.id, bytes.error());
  const std::string file = request.map + "." + request.format;
  answers_.give(replies_.granted(request.id, map_.revision(), *bytes, "saved " + file), content);
}

void MapsNode::list(const MapRequest& request) {
  const auto files = maps_.list();
  if (!files) return replies_.deny(kRequests, request.id, files.error());
  context_.bus.publish("out/map_list", encode(MapList{request.id, *files}, context_.bus.now()));
  replies_.grant(request.id, 0, static_cast<std::int64_t>(files->size()), "listed");
}

}  // namespace concord

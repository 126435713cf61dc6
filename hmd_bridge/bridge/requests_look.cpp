// Requests that only look: views, minimap, conflicts, history, scene, grid.

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "bridge/requests.hpp"
#include "core/voxel_boxes.hpp"

namespace concord::hmd {
namespace {

constexpr double kMaxSceneRadius = 20;
constexpr std::size_t kMaxSceneBoxes = 16'384;
constexpr std::int64_t kMaxGridCells = 16'000'000;
/// No reader takes a larger frame, however it is deflated.
constexpr std::size_t kMaxPoints = kMaxInflatedBytes / kPointBytes;

/// Points lie on surfaces: cells twice as wide hold a quarter of them. A tenth more, as rooms are no planes.
std::string too_many(std::size_t points, double resolution) {
  const double share = static_cast<double>(points) / static_cast<double>(kMaxPoints);
  char enough[40];
  std::snprintf(enough, sizeof(enough), "%.2f", std::ceil(resolution * std::sqrt(share) * 1.1 * 100) / 100);
  return std::to_string(points) + " points, and a frame holds " + std::to_string(kMaxPoints) +
         ": ask for a resolution of about " + enough + " m";
}

struct Looked {
  LayerCopy* copy;
  std::uint32_t stream;
  Transform T_layer_frame = Transform::Identity();
};

/// The layer that a request means, and where its frame lies in the layer's.
Granted<Looked> layer_of(Desk& desk, const Ask& ask, const ViewRequest& request) {
  if ((request.layer == Layer::kAgent) != request.agent.has_value())
    return no(Code::kBadRequest,
              request.agent ? "agent goes with layer agent alone" : "layer agent takes the agent's id");
  if (request.layer == Layer::kAgent) {
    if (desk.world.agent(*request.agent) == nullptr) return no(Code::kNoAgent, "no agent is called " + *request.agent);
    LayerCopy* copy = desk.world.agent_layer(*request.agent);
    if (copy == nullptr) return no(Code::kTooLarge, "as many agents are looked at as can be");
    return Looked{copy, copy->number()};
  }
  if (request.layer == Layer::kLabels && !desk.world.alive("semantic"))
    return no(Code::kUnavailable, "no process of this stack labels");
  const auto where = desk.place(ask, request.frame);
  if (!where) return tl::unexpected(where.error());
  const std::uint32_t stream = request.layer == Layer::kMap            ? kMapStream
                               : request.layer == Layer::kConflicts    ? kConflictStream
                               : request.layer == Layer::kLabels       ? kLabelStream
                               : request.layer == Layer::kGridOccupied ? kGridOccupiedStream
                                                                       : kGridFreeStream;
  return Looked{nullptr, stream, where->T_map_frame};
}

bool radii_are_good(const std::vector<double>& radii, std::size_t levels) {
  return !radii.empty() && radii.size() <= levels && radii.front() >= 0 && std::is_sorted(radii.begin(), radii.end());
}

template <class Request>
bool most_is_good(const Request& request) {
  return request.most >= 1 && request.most <= 1000;
}

}  // namespace

void work_on(Desk& desk, const Ask& ask, const ViewRequest& request) {
  const auto looked = layer_of(desk, ask, request);
  if (!looked) return desk.refuse(ask, looked.error());
  const ShownLayer& layer = *desk.hub.layers().find(looked->stream);
  if (!radii_are_good(request.radii, static_cast<std::size_t>(layer.store.levels()))) {
    return desk.hub.refuse(ask, Code::kBadRequest, "radii rise from 0 up, one for each level of the layer at most");
  }
  if (request.z && (*request.z)[0] >= (*request.z)[1])
    return desk.hub.refuse(ask, Code::kBadRequest, "z goes from low to high");
  ViewRegion region;
  region.centre = looked->T_layer_frame * Eigen::Vector3d(vector_of(request.centre));
  region.radii = request.radii;
  region.z = request.z;
  region.resolution = desk.context.site.resolution;
  const auto [blocks, lacking] = desk.hub.look(*desk.hub.find(ask.session), looked->stream, region);
  desk.hub.answer(ask,
                  ViewAnswer{looked->stream, static_cast<std::int64_t>(blocks), static_cast<std::int64_t>(lacking)});
}

void work_on(Desk& desk, const Ask& ask, const ViewCloseRequest& request) {
  const bool known = request.stream <= UINT32_MAX &&
                     desk.hub.look_away(*desk.hub.find(ask.session), static_cast<std::uint32_t>(request.stream));
  if (!known) return desk.hub.refuse(ask, Code::kNotFound, "there is no view of this stream");
  desk.hub.answer(ask, ViewCloseAnswer{});
}

void work_on(Desk& desk, const Ask& ask, const MinimapRequest& request) {
  const DownsampleRequest downsample{desk.id(ask), request.agent, request.resolution};
  const std::string id = downsample.id;
  desk.points[id];
  desk.asker.ask(
      {"in/downsample", encode(downsample, desk.now()), id, [&desk, id] { return all_there(desk.points, id); }, {}},
      [&desk, ask, id, agent = request.agent](const Answer& answer) {
        const auto parts = std::move(desk.points.extract(id).mapped());
        if (!answer.ok) {
          // Who sends nothing but where it is has no submap, and is no agent to ingest.
          const bool is_here = answer.code == "NO_AGENT" && desk.world.agent(agent) != nullptr;
          return desk.hub.refuse(ask, is_here ? Code::kNoMap : code_of(answer.code), answer.message);
        }
        std::vector<Eigen::Vector3f> points;
        for (const auto& [number, part] : parts) points.insert(points.end(), part.points.begin(), part.points.end());
        const Downsampled& first = parts.begin()->second;
        if (points.size() > kMaxPoints)
          return desk.hub.refuse(ask, Code::kTooLarge, too_many(points.size(), first.resolution));
        const FrameHead head{.kind = FrameKind::kPoints,
                             .stream = static_cast<std::uint32_t>(ask.id),
                             .count = static_cast<std::uint32_t>(points.size())};
        desk.hub.send(ask, std::make_shared<const Bytes>(make_frame(head, points_payload(points))));
        desk.hub.answer(ask, MinimapAnswer{first.agent, first.frame_id, static_cast<std::int64_t>(points.size())});
      });
}

void work_on(Desk& desk, const Ask& ask, const ConflictsRequest& request) {
  if (!most_is_good(request)) return desk.hub.refuse(ask, Code::kBadRequest, "most is 1 to 1000");
  const concord::ConflictRequest conflicts{desk.id(ask), request.most};
  const std::string id = conflicts.id;
  desk.conflicts[id];
  desk.asker.ask({"in/conflict_request",
                  encode(conflicts, desk.now()),
                  id,
                  [&desk, id] { return all_there(desk.conflicts, id); },
                  {}},
                 [&desk, ask, id](const Answer& answer) {
                   const auto parts = std::move(desk.conflicts.extract(id).mapped());
                   if (!answer.ok) return desk.hub.refuse(ask, code_of(answer.code), answer.message);
                   ConflictsAnswer out{{}, parts.begin()->second.regions_in_all, parts.begin()->second.voxels_in_all};
                   for (const auto& [number, part] : parts) {
                     for (const concord::ConflictRegion& region : part.regions) out.regions.push_back(to_hmd(region));
                   }
                   desk.hub.answer(ask, out);
                 });
}

void work_on(Desk& desk, const Ask& ask, const HistoryRequest& request) {
  if (!most_is_good(request)) return desk.hub.refuse(ask, Code::kBadRequest, "most is 1 to 1000");
  concord::HistoryRequest history;
  history.id = desk.id(ask);
  history.author = request.author.value_or("");
  history.subject = request.subject.value_or("");
  if (request.what) history.kind = from_hmd(*request.what);
  history.after_revision = request.after_revision.value_or(0);
  history.most = request.most;
  const std::string id = history.id;
  desk.history[id];
  desk.asker.ask(
      {"in/history_request", encode(history, desk.now()), id, [&desk, id] { return all_there(desk.history, id); }, {}},
      [&desk, ask, id](const Answer& answer) {
        const auto parts = std::move(desk.history.extract(id).mapped());
        if (!answer.ok) return desk.hub.refuse(ask, code_of(answer.code), answer.message);
        HistoryAnswer out;
        for (const auto& [number, part] : parts) {
          for (const concord::Operation& operation : part.operations) out.operations.push_back(to_hmd(operation));
        }
        desk.hub.answer(ask, out);
      });
}

void work_on(Desk& desk, const Ask& ask, const SceneGetRequest& request) {
  const auto where = desk.place(ask, request.frame);
  if (!where) return desk.refuse(ask, where.error());
  if (!(request.radius > 0 && request.radius <= kMaxSceneRadius))
    return desk.hub.refuse(ask, Code::kBadRequest, "a radius is up to 20 m");
  const BrickMap& map = desk.world.map().map();
  if (map.empty()) return desk.hub.refuse(ask, Code::kNoMap, "there is no map yet");
  const double r = desk.context.site.resolution;
  const Eigen::Vector3d centre = where->T_map_frame * Eigen::Vector3d(vector_of(request.centre));
  std::vector<VoxelIndex> voxels;
  map.for_each_brick([&](BrickIndex index, const Brick& brick) {
    const Eigen::Vector3d middle = (Eigen::Vector3d(index.x, index.y, index.z).array() * 8 + 4) * r;
    if ((middle - centre).norm() > request.radius + 8 * r) return;
    brick.for_each([&](int local, LogOdds value) {
      const VoxelIndex voxel = voxel_at(index, local);
      if (is_occupied(value) && (centre_of(voxel, r) - centre).norm() <= request.radius) voxels.push_back(voxel);
    });
  });
  std::sort(voxels.begin(), voxels.end());
  SceneGetAnswer answer;
  answer.revision = desk.world.corrections();
  answer.voxels.resolution = r;
  for (const VoxelBox& box : to_boxes(voxels)) {
    answer.voxels.boxes.push_back({box.min.x, box.min.y, box.min.z, box.max.x, box.max.y, box.max.z});
  }
  if (answer.voxels.boxes.size() > kMaxSceneBoxes)
    return desk.hub.refuse(ask, Code::kTooLarge, "too much for one answer; take a smaller radius");
  for (const concord::Zone& zone : desk.world.zones()) answer.zones.push_back(to_hmd(zone));
  desk.hub.answer(ask, answer);
}

void work_on(Desk& desk, const Ask& ask, const GridRequest& request) {
  const double r = desk.context.site.resolution;
  const auto [low, high] = request.z;
  // Layers of voxels whose centres lie between the heights, as the planner counts them.
  const double first_layer = std::ceil(low / r - 0.5 - 1e-9), end_layer = std::ceil(high / r - 0.5 - 1e-9);
  if (!(first_layer < end_layer) || std::abs(first_layer) > kMaxVoxel || std::abs(end_layer) > kMaxVoxel) {
    return desk.hub.refuse(ask, Code::kOutOfBounds,
                           "z goes from low to high within the map, over the centre of a voxel at least");
  }
  const auto from = static_cast<std::int32_t>(first_layer), to = static_cast<std::int32_t>(end_layer);
  struct Column {
    int free = 0;
    bool occupied = false;
  };
  std::map<std::pair<std::int32_t, std::int32_t>, std::array<Column, 64>> columns;  // by brick, y before x
  VoxelIndex min{INT32_MAX, INT32_MAX, 0}, max{INT32_MIN, INT32_MIN, 0};
  desk.world.map().map().for_each_brick([&](BrickIndex index, const Brick& brick) {
    if (index.z * 8 >= to || index.z * 8 + 8 <= from) return;
    auto& cells = columns[{index.y, index.x}];
    brick.for_each([&](int local, LogOdds value) {
      const VoxelIndex voxel = voxel_at(index, local);
      if (voxel.z < from || voxel.z >= to) return;
      Column& column = cells[static_cast<std::size_t>(local & 63)];
      column.occupied = column.occupied || is_occupied(value);
      if (is_free(value)) ++column.free;
      min = {std::min(min.x, voxel.x), std::min(min.y, voxel.y), 0};
      max = {std::max(max.x, voxel.x), std::max(max.y, voxel.y), 0};
    });
  });
  if (max.x < min.x) return desk.hub.refuse(ask, Code::kNoMap, "nothing was observed between these heights");
  const std::int64_t width = std::int64_t{max.x} - min.x + 1, depth = std::int64_t{max.y} - min.y + 1;
  if (width * depth > kMaxGridCells)
    return desk.hub.refuse(ask, Code::kTooLarge, "the map is too wide for one answer; use the grid layers");

  GridAnswer answer{r, {min.x, min.y}, {static_cast<std::int32_t>(width), static_cast<std::int32_t>(depth)}, 0, 0};
  Bytes payload;
  for (const std::int32_t part : {min.x, min.y, answer.size[0], answer.size[1]}) append_le(payload, part);
  const std::size_t begin = payload.size();
  payload.resize(begin + static_cast<std::size_t>(width * depth + 3) / 4);
  for (const auto& [place, cells] : columns) {
    for (int local = 0; local < 64; ++local) {
      const Column& column = cells[static_cast<std::size_t>(local)];
      const bool free = !column.occupied && 2 * column.free >= to - from;
      if (!column.occupied && !free) continue;
      ++(column.occupied ? answer.occupied : answer.free);
      const std::int64_t x = place.second * 8 + (local & 7) - min.x, y = place.first * 8 + (local >> 3) - min.y;
      const auto cell = static_cast<std::size_t>(x + y * width);
      payload[begin + cell / 4] =
          static_cast<std::uint8_t>(payload[begin + cell / 4] | (column.occupied ? 2 : 1) << (2 * (cell % 4)));
    }
  }
  const FrameHead head{.kind = FrameKind::kCells,
                       .stream = static_cast<std::uint32_t>(ask.id),
                       .count = static_cast<std::uint32_t>(width * depth)};
  desk.hub.send(ask, std::make_shared<const Bytes>(make_frame(head, payload)));
  desk.hub.answer(ask, answer);
}

}  // namespace concord::hmd

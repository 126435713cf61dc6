#include "cli/demo_person.hpp"

#include <fstream>
#include <optional>

#include "access/site_files.hpp"
#include "core/voxel_boxes.hpp"

namespace concord {
namespace {

constexpr double kPatience = 15.0;  // seconds: the bridge itself gives up after 10
constexpr std::int64_t kPoll = 100'000;

hmd::Pose pose_of(const Transform& T) {
  const Eigen::Vector3d p = T.translation();
  const Eigen::Quaterniond q(T.linear());
  return {{p.x(), p.y(), p.z()}, {q.x(), q.y(), q.z(), q.w()}};
}

}  // namespace

tl::expected<std::unique_ptr<DemoPerson>, Failure> DemoPerson::enter(Live& live, const std::string& name) {
  std::unique_ptr<DemoPerson> person(new DemoPerson(live, name));
  if (const Step there = person->come_in(); !there) return tl::unexpected(there.error());
  // Who does not answer pings is taken to have gone.
  live.bus().every(
      kPoll, [&client = person->client_] { client->poll(); }, person->here_);
  return person;
}

DemoPerson::Step DemoPerson::come_in() {
  std::ifstream in(hmd::address_file(live_.site()));
  std::string page, here;
  if (!std::getline(in, page) || !std::getline(in, here)) {
    return fail(Exit::kNoAnswer, "NO_ANSWER", "the bridge runs but does not say where");
  }
  auto client = hmd::BridgeClient::enter(here, name_);
  if (!client) return fail(Exit::kNoAnswer, "NO_ANSWER", client.error());
  page_ = page;
  client_ = std::move(*client);
  return {};
}

template <class Request>
DemoPerson::Step DemoPerson::ask(const Request& request) {
  std::optional<std::int64_t> id;
  live_.wait(kPatience, [&] {
    client_->poll();
    if (client_->lost()) {
      id.reset();
      if (!come_in()) return false;
    }
    if (!id) id = client_->ask(request);
    return client_->answer(*id) != nullptr;
  });
  const hmd::Json* answer = id ? client_->answer(*id) : nullptr;
  if (answer == nullptr) return live_.no_answer("the bridge");
  if (!answer->contains("error")) return {};
  const hmd::Json& error = (*answer)["error"];
  return fail(Exit::kRefused, error["code"].get<std::string>(), error["message"].get<std::string>());
}

DemoPerson::Step DemoPerson::place(const std::string& agent, const Transform& T_map_agent) {
  return ask(hmd::PlaceRequest{agent, pose_of(T_map_agent)});
}

DemoPerson::Step DemoPerson::add(std::span<const VoxelIndex> voxels, double resolution) {
  hmd::Voxels shape{resolution, {}};
  for (const VoxelBox& box : to_boxes(voxels)) {
    shape.boxes.push_back({box.min.x, box.min.y, box.min.z, box.max.x, box.max.y, box.max.z});
  }
  return ask(hmd::EditRequest{hmd::EditOp::kAdd, hmd::Frame::kMap, shape, {}, {}});
}

}  // namespace concord

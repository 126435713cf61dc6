#include "archives.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "arbitrary.hpp"

namespace concord::test {
namespace {

bool same(const Transform& a, const Transform& b) { return a.matrix() == b.matrix(); }

bool same(const Volume& a, const Volume& b) {
  if (a.index() != b.index()) return false;
  if (const auto* box = std::get_if<Box>(&a)) {
    return box->min == std::get<Box>(b).min && box->max == std::get<Box>(b).max;
  }
  if (const auto* box = std::get_if<OrientedBox>(&a)) {
    const auto& other = std::get<OrientedBox>(b);
    return same(box->T_frame_box, other.T_frame_box) && box->size == other.size;
  }
  const auto& prism = std::get<Prism>(a);
  const auto& other = std::get<Prism>(b);
  return prism.points == other.points && prism.low == other.low && prism.high == other.high;
}

struct SameWhat {
  const decltype(Correction::what)& other;

  bool operator()(const Correction::Edit& a) const {
    const auto& b = std::get<Correction::Edit>(other);
    return a.op == b.op && a.added == b.added && a.deleted == b.deleted;
  }
  bool operator()(const Correction::Undo& a) const {
    const auto& b = std::get<Correction::Undo>(other);
    return a.edit_id == b.edit_id && a.redo == b.redo;
  }
  bool operator()(const Correction::ZoneChange& change) const {
    const Zone& a = change.zone;
    const Zone& b = std::get<Correction::ZoneChange>(other).zone;
    return change.op == std::get<Correction::ZoneChange>(other).op && a.name == b.name && a.kind == b.kind &&
           a.author == b.author && a.utime == b.utime && a.revision == b.revision && same(a.volume, b.volume) &&
           same(a.T_map_zone, b.T_map_zone);
  }
  bool operator()(const Correction::Placement& a) const {
    const auto& b = std::get<Correction::Placement>(other);
    return a.agent == b.agent && a.frame_id == b.frame_id && a.incarnation == b.incarnation &&
           a.has_layer == b.has_layer && same(a.T_map_agent, b.T_map_agent);
  }
  bool operator()(const Correction::Weight& a) const {
    const auto& b = std::get<Correction::Weight>(other);
    return a.agent == b.agent && a.weight == b.weight;
  }
};

rc::Gen<std::string> arbitrary_name() {
  return rc::gen::map(rc::gen::pair(rc::gen::inRange(1, 41), rc::gen::element('a', 'Z', '7')),
                      [](const auto& p) { return std::string(static_cast<std::size_t>(p.first), p.second); });
}

double arbitrary_metres() { return *rc::gen::inRange(-1'000'000, 1'000'000) / 777.0; }
Eigen::Vector3d arbitrary_point() {
  const double x = arbitrary_metres();
  const double y = arbitrary_metres();
  return {x, y, arbitrary_metres()};
}

Transform arbitrary_transform() {
  const Eigen::Vector3d axis = arbitrary_point() + Eigen::Vector3d(0, 0, 1e4);
  Transform T = Transform::Identity();
  T.linear() = Eigen::AngleAxisd(arbitrary_metres(), axis.normalized()).toRotationMatrix();
  T.translation() = arbitrary_point();
  return T;
}

Volume arbitrary_volume() {
  switch (*rc::gen::inRange(0, 3)) {
    case 0: {
      const Eigen::Vector3d corner = arbitrary_point();
      return Box{corner, corner + arbitrary_point().cwiseAbs()};
    }
    case 1: return OrientedBox{arbitrary_transform(), arbitrary_point().cwiseAbs()};
    default: {
      Prism prism{{}, -1, arbitrary_point().cwiseAbs().x()};
      const int corners = *rc::gen::inRange(3, 65);
      for (int i = 0; i < corners; ++i) {
        const double angle = 6.283 * i / corners;
        prism.points.emplace_back(10 * std::cos(angle), 7 * std::sin(angle));
      }
      return prism;
    }
  }
}

std::vector<VoxelIndex> arbitrary_voxels() {
  const auto reach = *rc::gen::element(3, kMaxVoxel);
  std::set<VoxelIndex> voxels;
  const int count = *rc::gen::inRange(1, 40);
  for (int i = 0; i < count; ++i) {
    const int x = *rc::gen::inRange(-reach, reach);
    const int y = *rc::gen::inRange(-reach, reach);
    voxels.insert({x, y, *rc::gen::inRange(-reach, reach)});
  }
  return {voxels.begin(), voxels.end()};
}

Correction::Edit arbitrary_edit() {
  Correction::Edit edit;
  edit.op = *rc::gen::element(EditRequest::Op::kAdd, EditRequest::Op::kDelete, EditRequest::Op::kMove);
  if (edit.op != EditRequest::Op::kDelete) edit.added = arbitrary_voxels();
  if (edit.op != EditRequest::Op::kAdd) edit.deleted = arbitrary_voxels();
  std::erase_if(edit.deleted,
                [&](VoxelIndex v) { return std::binary_search(edit.added.begin(), edit.added.end(), v); });
  return edit;
}

/// Makes corrections that may follow one another.
class History {
 public:
  Correction next() {
    revision_ += *rc::gen::inRange<std::int64_t>(1, 1000);
    std::string id = "c" + std::to_string(revision_);
    auto what = arbitrary_what(id);
    Correction made{revision_,
                    std::move(id),
                    *rc::gen::element<std::string>("", "ann", "Zo\xC3\xAB B."),
                    *rc::gen::inRange<std::int64_t>(0, 1LL << 60),
                    *rc::gen::arbitrary<std::uint64_t>(),
                    std::move(what)};
    if (auto* change = std::get_if<Correction::ZoneChange>(&made.what)) {
      change->zone.author = made.author;
      change->zone.utime = made.utime;
      change->zone.revision = made.revision;
    }
    return made;
  }

 private:
  decltype(Correction::what) arbitrary_what(const std::string& id) {
    switch (*rc::gen::inRange(0, 5)) {
      case 0: return undo();
      case 1: return zone_change();
      case 2:
        return Correction::Placement{*arbitrary_name(), *arbitrary_name(), *rc::gen::arbitrary<std::int64_t>(),
                                     *rc::gen::arbitrary<bool>(), arbitrary_transform()};
      case 3: return Correction::Weight{*arbitrary_name(), *rc::gen::inRange(1, 1001)};
      default: break;
    }
    stands_[id] = true;
    return arbitrary_edit();
  }

  decltype(Correction::what) undo() {
    if (stands_.empty()) return Correction::Weight{"a", 1};
    auto& [id, stands] = *std::next(stands_.begin(), *rc::gen::inRange<std::ptrdiff_t>(0, std::ssize(stands_)));
    stands = !stands;
    return Correction::Undo{id, stands};
  }

  Correction::ZoneChange zone_change() {
    const std::string name = *rc::gen::element<std::string>("door", "by the caf\xC3\xA9", "3");
    if (zones_.insert(name).second) return filled(ZoneRequest::Op::kAdd, name);
    if (*rc::gen::arbitrary<bool>()) return filled(ZoneRequest::Op::kChange, name);
    zones_.erase(name);
    return zone_of(ZoneRequest::Op::kDelete, name, Box{});
  }

  static Correction::ZoneChange filled(ZoneRequest::Op op, const std::string& name) {
    Correction::ZoneChange change = zone_of(op, name, arbitrary_volume());
    change.zone.kind = *rc::gen::element(Zone::Kind::kNoGo, Zone::Kind::kAllowContact);
    change.zone.T_map_zone = arbitrary_transform();
    return change;
  }

  std::int64_t revision_ = 0;
  std::map<std::string, bool> stands_;
  std::set<std::string> zones_;
};

}  // namespace

Bytes write(const MapArchive& archive) {
  MapArchiveWriter writer(archive.resolution);
  for (const SavedLayer& layer : archive.layers) {
    const auto added = writer.add(layer.head, layer.bricks);
    if (!added) throw std::runtime_error(added.error().message);
  }
  for (const Correction& correction : archive.corrections) {
    const auto added = writer.add(correction);
    if (!added) throw std::runtime_error(added.error().message);
  }
  return std::move(writer).finish().value();
}

bool same(const Correction& a, const Correction& b) {
  return a.revision == b.revision && a.id == b.id && a.author == b.author && a.utime == b.utime &&
         a.content == b.content && a.what.index() == b.what.index() && std::visit(SameWhat{b.what}, a.what);
}

bool same(const MapArchive& a, const MapArchive& b) {
  const auto same_layer = [](const SavedLayer& x, const SavedLayer& y) {
    return x.head == y.head && x.bricks == y.bricks;
  };
  return a.resolution == b.resolution &&
         std::equal(a.layers.begin(), a.layers.end(), b.layers.begin(), b.layers.end(), same_layer) &&
         std::equal(a.corrections.begin(), a.corrections.end(), b.corrections.begin(), b.corrections.end(),
                    [](const Correction& x, const Correction& y) { return same(x, y); });
}

Correction correction(std::int64_t revision, std::string id, decltype(Correction::what) what) {
  Correction made{revision, std::move(id), "ann", 1'700'000'000'000'000 + revision, 7, std::move(what)};
  if (auto* change = std::get_if<Correction::ZoneChange>(&made.what)) {
    change->zone.author = made.author;
    change->zone.utime = made.utime;
    change->zone.revision = made.revision;
  }
  return made;
}

Correction::Edit edit_of(std::vector<VoxelIndex> added) { return {EditRequest::Op::kAdd, std::move(added), {}}; }

Correction::ZoneChange zone_of(ZoneRequest::Op op, std::string name, Volume volume) {
  Correction::ZoneChange change;
  change.op = op;
  change.zone.name = std::move(name);
  change.zone.volume = std::move(volume);
  return change;
}

MapArchive small_archive() {
  MapArchive archive;
  archive.resolution = 0.05;
  SavedLayer robot{{"robot1", "robot", "boot-7", 1'700'000'000'000'001, 3}, {}};
  robot.bricks.set({0, 0, 0}, Brick::uniform({0x0F}, kOccupied));
  robot.bricks.set({-5, 7, 1000}, Brick::uniform({0, ~std::uint64_t{0}}, kFree));
  archive.layers = {{{"headset", "headset", "f", 0, 1}, {}}, std::move(robot)};

  Transform turned = Transform::Identity();
  turned.linear() << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  turned.translation() << 1, 2, 3;
  const OrientedBox box{turned, {1, 2, 3}};
  archive.corrections = {
      correction(1, "p1", Correction::Placement{"robot1", "boot-7", 1'700'000'000'000'001, true, turned}),
      correction(2, "e1", edit_of({{0, 0, 0}, {0, 0, 1}, {-1, 5, 9}})),
      correction(4, "u1", Correction::Undo{"e1", false}),
      correction(5, "z1", zone_of(ZoneRequest::Op::kAdd, "door", box)),
      correction(6, "z2", zone_of(ZoneRequest::Op::kDelete, "door", Box{})),
      correction(9, "w1", Correction::Weight{"robot1", 3}),
  };
  std::sort(std::get<Correction::Edit>(archive.corrections[1].what).added.begin(),
            std::get<Correction::Edit>(archive.corrections[1].what).added.end());
  return archive;
}

rc::Gen<MapArchive> arbitrary_archive() {
  return rc::gen::exec([] {
    MapArchive archive;
    archive.resolution = *rc::gen::element(0.05, 0.1, 1e-4, 100.0, 1.0 / 3);
    const auto agents = *rc::gen::container<std::set<std::string>>(arbitrary_name());
    for (const std::string& agent : agents) {
      archive.layers.push_back({{agent, *arbitrary_name(), *arbitrary_name(), *rc::gen::arbitrary<std::int64_t>(),
                                 *rc::gen::inRange(1, 1001)},
                                *arbitrary_map(kMaxVoxel / kBrickSide)});
    }
    History history;
    const int corrections = *rc::gen::inRange(0, 30);
    for (int i = 0; i < corrections; ++i) archive.corrections.push_back(history.next());
    return archive;
  });
}

}  // namespace concord::test

#include "semantic/labels/semantic_cloud.hpp"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string_view>

#include "core/decimal.hpp"
#include "core/octomap_format.hpp"
#include "core/text.hpp"

namespace concord {
namespace {

constexpr const char* kResolutionWord = "concord resolution ";
constexpr const char* kClassWord = "concord class ";
constexpr std::size_t kMostHeader = 1'000'000;

/// The lines that say what the numbers mean, each behind the format's word for a comment.
std::string comments(const SemanticCloud& cloud, const std::string& word) {
  std::string out = word + kResolutionWord + decimal(cloud.resolution) + "\n";
  for (const auto& [id, name] : cloud.classes) out += word + kClassWord + std::to_string(id) + " " + name + "\n";
  return out;
}

void append(Bytes& out, const std::string& text) { out.insert(out.end(), text.begin(), text.end()); }
void append_float(Bytes& out, float value) { append_le(out, std::bit_cast<std::uint32_t>(value)); }

/// Different classes lie far apart on the circle of hues; instances differ in brightness.
std::array<std::uint8_t, 3> colour_of(std::uint32_t label, std::uint32_t instance) {
  if (label == 0) return {128, 128, 128};
  const double hue = std::fmod(label * 0.61803398875, 1.0) * 6.0, value = 1.0 - 0.12 * (instance % 5);
  const auto channel = [&](double shift) {
    const double k = std::fmod(shift + hue, 6.0);
    return static_cast<std::uint8_t>(
        std::lround(255.0 * value * (1.0 - 0.75 * std::clamp(std::min(k, 4.0 - k), 0.0, 1.0))));
  };
  return {channel(5), channel(3), channel(1)};
}

/// Takes lines off the front of a file.
class Header {
 public:
  explicit Header(ByteSpan file)
      : text_(reinterpret_cast<const char*>(file.data()), std::min(file.size(), kMostHeader)) {}

  std::optional<std::string_view> line() {
    const std::size_t end = text_.find('\n', at_);
    if (end == std::string_view::npos) return std::nullopt;
    const std::string_view out = text_.substr(at_, end - at_);
    at_ = end + 1;
    return out;
  }
  [[nodiscard]] bool expect(std::string_view wanted) { return line() == wanted; }
  [[nodiscard]] std::size_t at() const { return at_; }

 private:
  std::string_view text_;
  std::size_t at_ = 0;
};

template <class Number>
std::optional<Number> parse(std::string_view text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

tl::unexpected<Error> no_cloud(const std::string& what) {
  return refuse(Code::kMalformed, "this is no cloud of ours: " + what);
}

/// One of our comments, without the format's word for it. False: it cannot be one.
bool take_comment(std::string_view line, SemanticCloud& out) {
  const std::string_view resolution = kResolutionWord, named = kClassWord;
  if (line.starts_with(resolution)) {
    const auto value = parse<double>(line.substr(resolution.size()));
    if (value && checked_resolution(*value)) out.resolution = *value;
    return out.resolution > 0;
  }
  if (!line.starts_with(named)) return true;
  line.remove_prefix(named.size());
  const std::size_t space = line.find(' ');
  const auto id = space == std::string_view::npos ? std::nullopt : parse<std::uint32_t>(line.substr(0, space));
  const std::string name(space == std::string_view::npos ? "" : line.substr(space + 1));
  if (!id || *id == 0 || !is_title(name) || out.classes.size() >= kMaxClasses) return false;
  return out.classes.emplace(*id, name).second;
}

/// Refused: a count that is none, or of another number of bytes than are left.
Result<std::size_t> points_in(std::string_view count, ByteSpan left, std::size_t bytes_each) {
  const auto points = parse<std::uint64_t>(count);
  if (!points) return no_cloud("how many points it has");
  if (*points > kMaxCloudPoints) return refuse(Code::kTooLarge, "the cloud has too many points");
  if (left.size() != *points * bytes_each) return no_cloud("it ends early or late");
  return static_cast<std::size_t>(*points);
}

Result<void> check(const SemanticCloud& cloud) {
  if (cloud.resolution <= 0) return no_cloud("it does not say its resolution");
  for (const SemanticPoint& p : cloud.points) {
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z) || !std::isfinite(p.probability)) {
      return refuse(Code::kNotFinite, "a point of the cloud is no number");
    }
    if ((p.label == 0) != (p.instance == 0)) return no_cloud("a point has half a label");
    if (p.label != 0 && !cloud.classes.contains(p.label))
      return no_cloud("class " + std::to_string(p.label) + " has no name");
  }
  return {};
}

float take_float(ByteSpan& in) { return std::bit_cast<float>(*read_le<std::uint32_t>(in)); }

/// @pre so many bytes are there. @param skipped bytes between the coordinates and the rest.
std::vector<SemanticPoint> take_points(ByteSpan in, std::size_t points, std::size_t skipped) {
  std::vector<SemanticPoint> out;
  out.reserve(points);
  for (std::size_t i = 0; i < points; ++i) {
    SemanticPoint p;
    p.x = take_float(in), p.y = take_float(in), p.z = take_float(in);
    in = in.subspan(skipped);
    p.probability = take_float(in);
    p.label = *read_le<std::uint32_t>(in);
    p.instance = *read_le<std::uint32_t>(in);
    out.push_back(p);
  }
  return out;
}

constexpr const char* kPcdBegin = "# .PCD v0.7 - Point Cloud Data file format";
constexpr std::array kPcdFields{"VERSION 0.7", "FIELDS x y z probability label instance", "SIZE 4 4 4 4 4 4",
                                "TYPE F F F F U U", "COUNT 1 1 1 1 1 1"};
constexpr std::array kPlyFields{
    "property float x",       "property float y",    "property float z",           "property uchar red",
    "property uchar green",   "property uchar blue", "property float probability", "property uint label",
    "property uint instance", "end_header"};
constexpr std::size_t kPcdBytes = 24, kPlyBytes = 27, kColourBytes = 3;

}  // namespace

Result<SemanticCloud> semantic_cloud(const BrickMap& map, const BrickMap& labels, const std::vector<LabelSlot>& slots,
                                     double resolution) {
  SemanticCloud out;
  out.resolution = resolution;
  std::map<std::int32_t, InstanceId> by_slot;
  std::map<ClassId, std::string> names;
  for (const LabelSlot& slot : slots) {
    by_slot[slot.slot] = slot.of;
    names[slot.of.label] = slot.name;
  }
  std::vector<std::pair<VoxelIndex, LogOdds>> voxels;
  map.for_each_brick([&](BrickIndex index, const Brick& brick) {
    brick.for_each([&](int local, LogOdds value) {
      if (is_occupied(value)) voxels.emplace_back(voxel_at(index, local), value);
    });
  });
  std::ranges::sort(voxels);
  for (const auto& [voxel, value] : voxels) {
    const Eigen::Vector3f p = centre_of(voxel, resolution).cast<float>();
    SemanticPoint point{p.x(), p.y(), p.z(), static_cast<float>(1.0 / (1.0 + std::exp(-to_double(value)))), 0, 0};
    if (const LogOdds label = labels.at(voxel); is_known(label)) {
      const auto it = by_slot.find(slot_of_value(label));
      if (it == by_slot.end()) return refuse(Code::kNotFound, "what is labelled there is not known yet");
      point.label = it->second.label;
      point.instance = it->second.instance;
      out.classes[point.label] = names.at(point.label);
    }
    out.points.push_back(point);
  }
  return out;
}

Bytes write_pcd(const SemanticCloud& cloud) {
  const std::string count = std::to_string(cloud.points.size());
  Bytes out;
  append(out, std::string(kPcdBegin) + "\n" + comments(cloud, "# "));
  for (const char* line : kPcdFields) append(out, std::string(line) + "\n");
  append(out, "WIDTH " + count + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + count + "\nDATA binary\n");
  out.reserve(out.size() + kPcdBytes * cloud.points.size());
  for (const SemanticPoint& p : cloud.points) {
    for (const float value : {p.x, p.y, p.z, p.probability}) append_float(out, value);
    append_le(out, p.label);
    append_le(out, p.instance);
  }
  return out;
}

Bytes write_ply(const SemanticCloud& cloud) {
  Bytes out;
  append(out, "ply\nformat binary_little_endian 1.0\n" + comments(cloud, "comment "));
  append(out, "element vertex " + std::to_string(cloud.points.size()) + "\n");
  for (const char* line : kPlyFields) append(out, std::string(line) + "\n");
  out.reserve(out.size() + kPlyBytes * cloud.points.size());
  for (const SemanticPoint& p : cloud.points) {
    for (const float value : {p.x, p.y, p.z}) append_float(out, value);
    for (const std::uint8_t c : colour_of(p.label, p.instance)) out.push_back(c);
    append_float(out, p.probability);
    append_le(out, p.label);
    append_le(out, p.instance);
  }
  return out;
}

Result<SemanticCloud> read_pcd(ByteSpan file) {
  Header header(file);
  SemanticCloud out;
  if (!header.expect(kPcdBegin)) return no_cloud("it does not begin as a .pcd");
  auto line = header.line();
  for (; line && line->starts_with("# "); line = header.line()) {
    if (!take_comment(line->substr(2), out)) return no_cloud("a comment of ours is none");
  }
  for (const char* field : kPcdFields) {
    if (line != std::string_view(field)) return no_cloud("it has other fields");
    line = header.line();
  }
  if (!line || !line->starts_with("WIDTH ")) return no_cloud("it has no width");
  const std::string_view count = line->substr(6);
  if (!header.expect("HEIGHT 1") || !header.expect("VIEWPOINT 0 0 0 1 0 0 0") ||
      !header.expect("POINTS " + std::string(count)) || !header.expect("DATA binary")) {
    return no_cloud("it is not one row of binary points");
  }
  const ByteSpan data = file.subspan(header.at());
  const auto points = points_in(count, data, kPcdBytes);
  if (!points) return tl::unexpected(points.error());
  out.points = take_points(data, *points, 0);
  if (const auto fine = check(out); !fine) return tl::unexpected(fine.error());
  return out;
}

Result<SemanticCloud> read_ply(ByteSpan file) {
  Header header(file);
  SemanticCloud out;
  if (!header.expect("ply") || !header.expect("format binary_little_endian 1.0"))
    return no_cloud("it does not begin as our .ply");
  auto line = header.line();
  for (; line && line->starts_with("comment "); line = header.line()) {
    if (!take_comment(line->substr(8), out)) return no_cloud("a comment of ours is none");
  }
  if (!line || !line->starts_with("element vertex ")) return no_cloud("it has no points");
  const std::string_view count = line->substr(15);
  for (const char* field : kPlyFields) {
    if (!header.expect(field)) return no_cloud("it has other properties");
  }
  const ByteSpan data = file.subspan(header.at());
  const auto points = points_in(count, data, kPlyBytes);
  if (!points) return tl::unexpected(points.error());
  out.points = take_points(data, *points, kColourBytes);
  if (const auto fine = check(out); !fine) return tl::unexpected(fine.error());
  return out;
}

Result<std::map<InstanceId, std::vector<VoxelIndex>>> instances_of(const SemanticCloud& cloud) {
  std::map<InstanceId, std::vector<VoxelIndex>> out;
  for (const SemanticPoint& p : cloud.points) {
    const Eigen::Vector3d at = Eigen::Vector3d(p.x, p.y, p.z) / cloud.resolution;
    if (!(at.cwiseAbs().maxCoeff() < kMaxVoxel)) return refuse(Code::kOutOfBounds, "a point lies beyond any map");
    if (p.label != 0) out[{p.label, p.instance}].push_back(voxel_of(at, 1.0));
  }
  for (auto& [of, voxels] : out) {
    std::ranges::sort(voxels);
    voxels.erase(std::unique(voxels.begin(), voxels.end()), voxels.end());
  }
  return out;
}

}  // namespace concord

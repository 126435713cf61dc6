#include "planner/files/map_server.hpp"

#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include <yaml-cpp/yaml.h>

namespace concord {
namespace {

constexpr std::size_t kMaxYaml = 65'536;

MapServerInfo info_of(const YAML::Node& root) {
  MapServerInfo info;
  info.image = root["image"].as<std::string>();
  info.resolution = root["resolution"].as<double>();
  const auto origin = root["origin"].as<std::array<double, 3>>();
  info.origin = {origin[0], origin[1]};
  // A yaw of 0 is all that a grid of square cells along the axes can have.
  if (origin[2] != 0) throw YAML::Exception(root.Mark(), "the origin is turned");
  if (const auto negate = root["negate"]) info.negate = negate.as<int>() != 0;
  if (const auto mode = root["mode"]; mode && mode.as<std::string>() != "trinary") {
    throw YAML::Exception(root.Mark(), "its mode is not trinary");
  }
  info.occupied_thresh = root["occupied_thresh"].as<double>();
  info.free_thresh = root["free_thresh"].as<double>();
  return info;
}

Result<MapServerInfo> checked(MapServerInfo info) {
  if (info.image.empty() || info.image.find_first_of("/\\") != std::string::npos) {
    return refuse(Code::kMalformed, "its image must be a file beside it");
  }
  if (!info.origin.allFinite() || !std::isfinite(info.occupied_thresh) || !std::isfinite(info.free_thresh)) {
    return refuse(Code::kNotFinite, "its origin and thresholds must be numbers");
  }
  if (!(info.resolution >= 0.001 && info.resolution <= 10)) {
    return refuse(Code::kBadResolution, "its resolution must be from 0.001 to 10 m");
  }
  return info;
}

/// Takes the numbers off the front of a .pgm, which may have comments between them.
class PgmHeader {
 public:
  explicit PgmHeader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  std::optional<std::int64_t> number() {
    skip();
    std::int64_t value = 0;
    const std::size_t begin = at_;
    for (; at_ < bytes_.size() && bytes_[at_] >= '0' && bytes_[at_] <= '9'; ++at_) {
      value = 10 * value + (bytes_[at_] - '0');
      if (value > kMaxPgmCells) return std::nullopt;
    }
    return at_ == begin ? std::nullopt : std::optional(value);
  }
  /// What comes after the one blank that ends the header.
  [[nodiscard]] std::span<const std::uint8_t> rest() const {
    return at_ < bytes_.size() ? bytes_.subspan(at_ + 1) : std::span<const std::uint8_t>();
  }

 private:
  void skip() {
    bool in_comment = false;
    for (; at_ < bytes_.size(); ++at_) {
      const char c = static_cast<char>(bytes_[at_]);
      if (c == '\n') in_comment = false;
      if (c == '#') in_comment = true;
      if (!in_comment && c != ' ' && c != '\t' && c != '\n' && c != '\r') return;
    }
  }

  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = 2;
};

/// What each grey value says of a cell.
std::array<LogOdds, 256> states_of(const MapServerInfo& info, double white) {
  std::array<LogOdds, 256> states{};
  for (std::size_t grey = 0; grey < states.size(); ++grey) {
    const double share = static_cast<double>(grey) / white;
    const double occupied = info.negate ? share : 1 - share;
    states[grey] = occupied > info.occupied_thresh ? kOccupied : occupied < info.free_thresh ? kFree : kUnknown;
  }
  return states;
}

}  // namespace

Result<MapServerInfo> read_map_server_yaml(std::string_view text) {
  if (text.size() > kMaxYaml) return refuse(Code::kTooLarge, "a map_server file is shorter than 64 kB");
  try {
    return checked(info_of(YAML::Load(std::string(text))));
  } catch (const YAML::Exception& e) {
    return refuse(Code::kMalformed, std::string("not a map_server file: ") + e.what());
  }
}

Result<BrickMap> read_map_server_pgm(const MapServerInfo& info, std::span<const std::uint8_t> bytes) {
  if (bytes.size() < 2 || bytes[0] != 'P' || bytes[1] != '5') {
    return refuse(Code::kMalformed, "not a binary .pgm (P5)");
  }
  PgmHeader header(bytes);
  const auto width = header.number();
  const auto height = header.number();
  const auto white = header.number();
  if (!width || !height || !white || *width < 1 || *height < 1 || *white < 1 || *white > 255) {
    return refuse(Code::kMalformed, "the .pgm has no width, height and white of at most 255");
  }
  if (*width > kMaxVoxel || *height > kMaxVoxel || *width * *height > kMaxPgmCells) {
    return refuse(Code::kTooLarge, "the .pgm has over 100 million cells, or too long a side");
  }
  const std::span<const std::uint8_t> greys = header.rest();
  if (static_cast<std::int64_t>(greys.size()) < *width * *height) {
    return refuse(Code::kMalformed, "the .pgm ends too early");
  }
  const std::array<LogOdds, 256> states = states_of(info, static_cast<double>(*white));
  BrickMap map;
  DenseBrick dense;
  for (std::int64_t y0 = 0; y0 < *height; y0 += kBrickSide) {
    for (std::int64_t x0 = 0; x0 < *width; x0 += kBrickSide) {
      dense.fill(kUnknown);
      for (std::int64_t y = y0; y < std::min<std::int64_t>(y0 + kBrickSide, *height); ++y) {
        const std::uint8_t* row = greys.data() + (*height - 1 - y) * *width;
        for (std::int64_t x = x0; x < std::min<std::int64_t>(x0 + kBrickSide, *width); ++x) {
          dense[static_cast<std::size_t>((x - x0) + kBrickSide * (y - y0))] = states[row[x]];
        }
      }
      map.set({static_cast<std::int32_t>(x0 / kBrickSide), static_cast<std::int32_t>(y0 / kBrickSide), 0},
              Brick::from_dense(dense));
    }
  }
  return map;
}

}  // namespace concord

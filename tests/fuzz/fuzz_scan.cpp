#include <array>
#include <bit>

#include "core/byte_stream.hpp"
#include "core/scan.hpp"
#include "must.hpp"

using namespace concord;

/// Any floats as points, any doubles as sensor position and range: taken or refused, the map stays within its clamps.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  ByteSpan in(data, size);
  const auto real = [&] { return std::bit_cast<double>(read_le<std::uint64_t>(in).value_or(0)); };
  const std::uint8_t choice = read_le<std::uint8_t>(in).value_or(0);
  constexpr std::array<double, 4> kResolutions{0.05, 0.5, 0.01, 10.0};
  const double resolution = kResolutions[choice & 3];

  Scan scan;
  if ((choice & 4) != 0) {
    scan.T_agent_sensor = Transform::Identity();
    scan.T_agent_sensor->translation() = Eigen::Vector3d(real(), real(), real());
  }
  if ((choice & 8) != 0) scan.max_range = real();
  while (in.size() >= 12) {
    Eigen::Vector3f p;
    for (float& c : p) c = std::bit_cast<float>(*read_le<std::uint32_t>(in));
    scan.points.push_back(p);
  }
  const std::size_t points = scan.points.size();
  const Result<CheckedScan> ready = checked(std::move(scan), resolution);
  if (!ready) return 0;
  fuzz::must(ready->scan.points.size() + ready->skipped == points);

  BrickMap map;
  const auto changed = integrate(map, resolution, ready->scan);
  if (!changed) return 0;
  fuzz::must(changed->size() == map.brick_count());
  map.for_each_brick([](BrickIndex index, const Brick& brick) {
    fuzz::must(in_bounds(index));
    brick.for_each([](int, LogOdds l) { fuzz::must(l == kHit || l == kMiss); });
  });
  return 0;
}

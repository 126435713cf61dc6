// How a relief is lit and coloured.

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "cli/relief.hpp"

namespace concord {
namespace {

constexpr double kStripe = 0.4;  // metres along x

/// Twelve directions, evenly.
constexpr std::array<std::array<float, 2>, 12> kRing = {{{1, 0},
                                                         {.87F, .5F},
                                                         {.5F, .87F},
                                                         {0, 1},
                                                         {-.5F, .87F},
                                                         {-.87F, .5F},
                                                         {-1, 0},
                                                         {-.87F, -.5F},
                                                         {-.5F, -.87F},
                                                         {0, -1},
                                                         {.5F, -.87F},
                                                         {.87F, -.5F}}};

/// How much light reaches a cell, 0 to 1: open sky (soft) and the sun at the upper left.
class Light {
 public:
  Light(const Relief& relief, double resolution) : relief_(relief), resolution_(resolution) {}

  [[nodiscard]] float at(int column, int row) const {
    const float here = height(column, row);
    return (1.0F - 0.36F * closed_sky(column, row, here)) * (1.0F - 0.13F * shadow(column, row, here));
  }

  /// Low, and hardly above the lowest surface around: floors are uneven.
  [[nodiscard]] bool is_ground(int column, int row) const {
    constexpr float kLow = 1.2F;
    const float here = height(column, row), floor = static_cast<float>(relief_.floor);
    if (here > floor + kLow) return false;
    float lowest = here;
    for (const float reach : {0.4F, 0.8F, 1.2F}) {
      for (const auto& [dx, dy] : kRing) {
        const Relief::Cell& other = cell(column + cells(dx * reach), row + cells(dy * reach));
        if (other.solid()) lowest = std::min(lowest, other.top);
      }
    }
    return here < std::max(lowest, floor) + 2.5F * static_cast<float>(resolution_);
  }

 private:
  /// The nearest one that is on the picture.
  [[nodiscard]] const Relief::Cell& cell(int column, int row) const {
    column = std::clamp(column, 0, relief_.width - 1);
    row = std::clamp(row, 0, relief_.height - 1);
    return relief_.cells[static_cast<std::size_t>(row) * relief_.width + column];
  }

  [[nodiscard]] float height(int column, int row) const {
    const auto floor = static_cast<float>(relief_.floor);
    const Relief::Cell& here = cell(column, row);
    return here.solid() ? std::max(here.top, floor) : floor;
  }

  [[nodiscard]] int cells(float metres) const { return static_cast<int>(std::lround(metres / resolution_)); }

  [[nodiscard]] float closed_sky(int column, int row, float here) const {
    float closed = 0;
    for (const float reach : {0.12F, 0.3F, 0.6F}) {
      for (const auto& [dx, dy] : kRing) {
        const float rise = height(column + cells(dx * reach), row + cells(dy * reach)) - here;
        closed += std::clamp(rise / (reach * 2.5F), 0.0F, 1.0F);
      }
    }
    return closed / (3.0F * kRing.size());
  }

  [[nodiscard]] float shadow(int column, int row, float here) const {
    constexpr float kSlope = 2.4F;  // rise over run of the sun
    const int steps = std::min(48, static_cast<int>(1.6 / resolution_));
    float dark = 0;
    for (int step = 1; step <= steps; ++step) {
      const float run = static_cast<float>(step) * static_cast<float>(resolution_) * 1.414F;
      const float over = height(column - step, row + step) - here - run * kSlope;
      dark = std::max(dark, std::clamp(over / 0.5F, 0.0F, 1.0F));
    }
    return dark;
  }

  const Relief& relief_;
  double resolution_;
};

constexpr Rgb kNobody{0.56F, 0.53F, 0.49F};
constexpr Rgb kFloor{0.985F, 0.98F, 0.965F};

/// One agent's own colour; where several agree, slanted stripes of theirs.
Rgb tint_of(std::uint32_t claims, int stripe) {
  const int agents = std::popcount(claims);
  if (agents == 0) return kNobody;
  for (int skip = stripe % agents; skip > 0; --skip) claims &= claims - 1;
  return agent_colour(static_cast<std::size_t>(std::countr_zero(claims)));
}

/// The ground is seen by everyone: stripes there would only be loud.
Rgb mean_of(std::uint32_t claims) {
  const int agents = std::popcount(claims);
  if (agents == 0) return kNobody;
  Rgb sum;
  for (int i = 0; i < agents; ++i) {
    const Rgb colour = tint_of(claims, i);
    sum = {sum.r + colour.r, sum.g + colour.g, sum.b + colour.b};
  }
  return sum.scaled(1.0F / static_cast<float>(agents));
}

std::uint32_t packed(const Rgb& colour) {
  const auto byte = [](float v) { return static_cast<std::uint32_t>(std::lround(std::clamp(v, 0.0F, 1.0F) * 255.0F)); };
  return 0xFF000000U | byte(colour.r) << 16 | byte(colour.g) << 8 | byte(colour.b);
}

}  // namespace

Rgb agent_colour(std::size_t i) {
  static constexpr std::array<Rgb, 8> kPalette = {{{0.16F, 0.42F, 0.72F},    // blue
                                                   {0.93F, 0.56F, 0.15F},    // orange
                                                   {0.48F, 0.33F, 0.66F},    // violet
                                                   {0.80F, 0.66F, 0.13F},    // gold
                                                   {0.36F, 0.47F, 0.56F},    // slate
                                                   {0.85F, 0.45F, 0.60F},    // rose
                                                   {0.55F, 0.40F, 0.25F},    // brown
                                                   {0.30F, 0.30F, 0.62F}}};  // indigo
  return kPalette[i % kPalette.size()];
}

std::vector<std::uint32_t> shade(const Relief& relief, double resolution, double cut) {
  std::vector<std::uint32_t> pixels(relief.cells.size(), 0);
  const Light light(relief, resolution);
  const double span = std::max(cut - relief.floor, resolution);
  const int stripe = std::max(2, static_cast<int>(std::lround(kStripe / resolution)));
  for (int row = 0; row < relief.height; ++row) {
    for (int column = 0; column < relief.width; ++column) {
      const std::size_t i = static_cast<std::size_t>(row) * relief.width + column;
      const Relief::Cell& cell = relief.cells[i];
      if (!cell.seen) continue;
      Rgb colour = kFloor;
      if (cell.solid()) {
        const auto rise = static_cast<float>(std::clamp((cell.top - relief.floor) / span, 0.0, 1.0));
        const bool ground = light.is_ground(column, row);
        const float strength = ground ? 0.13F : 0.42F + 0.58F * std::sqrt(rise);
        const Rgb tint = ground ? mean_of(cell.claims) : tint_of(cell.claims, (column + row) / stripe);
        colour = kFloor.mixed(tint, strength).scaled(1.0F - 0.32F * rise * rise);
      }
      pixels[i] = packed(colour.scaled(light.at(column, row)));
    }
  }
  return pixels;
}

}  // namespace concord

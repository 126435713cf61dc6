#include "align/evidence.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <Eigen/Eigenvalues>

#include "align/workers.hpp"

namespace concord {
namespace {

constexpr std::size_t kPiecesPerChunk = 512;
constexpr float kUprightNormalZ = 0.6F;
constexpr double kSameFacing = 0.8;  // cosine of 37 degrees
/// Across a surface, in cells of it (twice the resolution): three quarters of a cell, 1.5 voxels.
constexpr double kAcross = 0.75;
/// From the nearest surface, in cells: nearer than that nothing is contradicted, as poses drift and edges fray.
constexpr double kClear = 1.5;

/// Cells whose normals scatter by 6 degrees put this share of their weight on directions that nothing measures.
constexpr double kLooseShare = 0.015;
constexpr double kPairsPerMeasurement = 10.0;
constexpr double kMinSigma = 0.01;  // metres across a surface: what a lattice can hide

struct Asked {
  Verdicts upright, level;
};

Asked ask(const SurfaceLevel& surface, const FreeSpace& free, const SurfaceLevel& other, const Transform& T,
          std::size_t begin, std::size_t end, std::size_t stride) {
  Asked out;
  const double area = other.size() * other.size() * static_cast<double>(stride);
  const double across = kAcross * surface.size();
  const double clear = kClear * surface.size();
  for (std::size_t i = begin; i < end; ++i) {
    const SurfaceCell& piece = other.cells()[i * stride];
    if (!piece.is_flat()) continue;
    Verdicts& verdicts = std::abs(piece.normal.z()) < kUprightNormalZ ? out.upright : out.level;
    verdicts.all += area;
    const Eigen::Vector3d p = T * piece.mean.cast<double>();
    const SurfaceCell* nearest = surface.nearest(p);
    if (nearest != nullptr) {
      const Eigen::Vector3d d = nearest->mean.cast<double>() - p;
      if (d.norm() < clear) {
        const Eigen::Vector3d n = nearest->normal.cast<double>();
        const bool faces = std::abs(n.dot(T.linear() * piece.normal.cast<double>())) > kSameFacing;
        if (faces && std::abs(n.dot(d)) < across) verdicts.matched += area;
        continue;
      }
    }
    if (free.contains(p)) verdicts.contradicted += area;
  }
  return out;
}

Asked ask_all(const AlignMap& map, const AlignMap& other, const Transform& T, std::size_t pieces, int threads) {
  const SurfaceLevel& surface = other.fine();
  const std::size_t stride = std::max<std::size_t>(1, surface.cells().size() / std::max<std::size_t>(pieces, 1));
  const std::size_t count = chunks_of(surface.cells().size(), stride);
  std::vector<Asked> parts(chunks_of(count, kPiecesPerChunk));
  for_each_chunk(threads, parts.size(), [&](std::size_t chunk) {
    parts[chunk] = ask(map.fine(), map.free, surface, T, chunk * kPiecesPerChunk,
                       std::min(count, (chunk + 1) * kPiecesPerChunk), stride);
  });
  Asked out;
  for (const Asked& part : parts) {
    out.upright.add(part.upright);
    out.level.add(part.level);
  }
  return out;
}

double share(const Verdicts& a, const Verdicts& b) {
  return a.all + b.all > 0.0 ? (a.matched + b.matched) / (a.all + b.all) : 0.0;
}

std::string in_axes(const Eigen::Vector3d& axis) {
  int largest = 0;
  axis.cwiseAbs().maxCoeff(&largest);
  const Eigen::Vector3d a = axis[largest] < 0.0 ? Eigen::Vector3d(-axis) : axis;
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%c (%.2f %.2f %.2f)", "xyz"[largest], a.x(), a.y(), a.z());
  return text.data();
}

}  // namespace

double Support::overlap_source() const { return share(source_upright, source_level); }
double Support::overlap_target() const { return share(target_upright, target_level); }

double Support::score() const {
  const Verdicts v = upright();
  return 0.5 * v.matched - v.contradicted;
}

Support support(const AlignMap& target, const AlignMap& source, const Transform& T_target_source, std::size_t pieces,
                int threads) {
  const Asked of_source = ask_all(target, source, T_target_source, pieces, threads);
  const Asked of_target = ask_all(source, target, T_target_source.inverse(), pieces, threads);
  return {of_source.upright, of_source.level, of_target.upright, of_target.level};
}

std::string name_slide(const Eigen::Vector3d& axis) { return "slides along " + in_axes(axis); }

std::vector<LooseDirection> loose_directions(const GicpResult& result) {
  std::vector<LooseDirection> out;
  if (!(result.weight > 0.0)) return out;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> along(result.hessian.bottomRightCorner<3, 3>());
  for (int i = 0; i < 3; ++i) {
    if (along.eigenvalues()[i] > kLooseShare * result.weight) continue;
    out.push_back({along.eigenvectors().col(i), false, name_slide(along.eigenvectors().col(i))});
  }
  return out;
}

Matrix6 covariance(const GicpResult& result) {
  const double sigma = std::max(result.rms, kMinSigma);
  const Matrix6 damped =
      result.hessian + 1e-9 * std::max(result.hessian.diagonal().maxCoeff(), 1e-9) * Matrix6::Identity();
  const Matrix6 inverse = damped.ldlt().solve(Matrix6::Identity());
  return sigma * sigma * kPairsPerMeasurement * 0.5 * (inverse + inverse.transpose());
}

}  // namespace concord

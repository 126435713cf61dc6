#include "align/evidence.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "align/sampling.hpp"
#include "align/workers.hpp"

namespace concord {
namespace {

constexpr std::size_t kPiecesPerChunk = 512;
constexpr float kUprightNormalZ = 0.6F;
constexpr double kSameFacing = 0.8;  // cosine of 37 degrees
/// Across a surface, in cells of it (twice the resolution): 1.5 voxels.
constexpr double kAcross = 0.75;
/// From the nearest surface, in cells: nearer than that nothing is contradicted, as poses drift and edges fray.
constexpr double kClear = 1.5;
constexpr double kTouch = 1.0;  // cells: how near a solid piece must be to anything
constexpr double kScoreAgainst = 10.0;
constexpr double kContested = 4.0;
constexpr double kContestedShare = 0.01;

constexpr double kPairsPerMeasurement = 10.0;
constexpr double kMinSigma = 0.01;  // metres across a surface: what a lattice can hide

struct Asked {
  Verdicts upright, level;
  Eigen::Matrix2d matched = Eigen::Matrix2d::Zero();  // in the target's axes
  Eigen::Matrix2d against = Eigen::Matrix2d::Zero();
  void add(const Asked& other) {
    upright.add(other.upright);
    level.add(other.level);
    matched += other.matched;
    against += other.against;
  }
};

enum class Answer { kNothing, kMatched, kDisplaced, kContradicted };

/// What a map says of a piece of surface at `p` with normal `n`. `size`: of the larger cells of the two, since the mean
/// of a large one lies off the surface where it bends.
Answer answer(const AlignMap& map, const Eigen::Vector3d& p, const Eigen::Vector3d& n, const SurfaceCell& piece,
              double size) {
  const SurfaceCell* nearest = map.fine().nearest(p);
  if (nearest != nullptr) {
    const Eigen::Vector3d d = nearest->mean.cast<double>() - p;
    if (d.norm() < kClear * size) {
      if (piece.is_solid) return d.norm() < kTouch * size ? Answer::kMatched : Answer::kNothing;
      if (!nearest->is_flat()) return Answer::kNothing;
      const Eigen::Vector3d m = nearest->normal.cast<double>();
      const double across = std::abs(m.dot(d));
      const double cosine = m.dot(n);
      if (back_to_back(*nearest, piece, cosine)) return Answer::kNothing;
      if (std::abs(cosine) > kSameFacing && across < kAcross * size) return Answer::kMatched;
      const double along = std::sqrt(std::max(0.0, d.squaredNorm() - across * across));
      return along < size ? Answer::kDisplaced : Answer::kNothing;
    }
  }
  return map.free.contains(p) ? Answer::kContradicted : Answer::kNothing;
}

/// `R_target_other`: from the asked one's axes to the target's, in which up is z; the source's z may be anything.
/// Calls `heard(piece, p_map, n_target, is_upright, area, answer)` for each piece of the other map that is asked.
template <typename Heard>
void ask_each(const AlignMap& map, const SurfaceLevel& other, const Transform& T, const Eigen::Matrix3d& R_target_other,
              std::size_t begin, std::size_t end, std::size_t count, const Heard& heard) {
  const double area =
      other.size() * other.size() * static_cast<double>(other.cells().size()) / static_cast<double>(count);
  const double size = std::max(map.fine().size(), other.size());
  StopLook stop;
  for (std::size_t i = begin; i < end; ++i) {
    stop.step();
    const SurfaceCell& piece = other.cells()[spread(i, count, other.cells().size())];
    if (!piece.is_flat() && !piece.is_solid) continue;
    const Eigen::Vector3d n_target = R_target_other * piece.normal.cast<double>();
    const Eigen::Vector3d p = T * piece.mean.cast<double>();
    const Eigen::Vector3d n = T.linear() * piece.normal.cast<double>();
    heard(piece, p, n_target, std::abs(n_target.z()) < kUprightNormalZ, area, answer(map, p, n, piece, size));
  }
}

/// A solid piece holds nothing: an edge may slide along itself. But where it should not be it speaks in all directions.
Eigen::Matrix2d facing_against(const SurfaceCell& piece, const Eigen::Vector3d& n, double area) {
  if (piece.is_solid) return 0.5 * area * Eigen::Matrix2d::Identity();
  return area * n.head<2>() * n.head<2>().transpose();
}

Asked ask(const AlignMap& map, const SurfaceLevel& other, const Transform& T, const Eigen::Matrix3d& R_target_other,
          std::size_t begin, std::size_t end, std::size_t count) {
  Asked out;
  ask_each(
      map, other, T, R_target_other, begin, end, count,
      [&](const SurfaceCell& piece, const Eigen::Vector3d&, const Eigen::Vector3d& n, bool is_upright, double area,
          Answer said) {
        Verdicts& verdicts = is_upright ? out.upright : out.level;
        verdicts.all += area;
        if (said == Answer::kNothing) return;
        const bool matched = said == Answer::kMatched;
        (matched ? verdicts.matched : said == Answer::kDisplaced ? verdicts.displaced : verdicts.contradicted) += area;
        if (matched && is_upright && !piece.is_solid) {
          out.matched += area * n.head<2>() * n.head<2>().transpose();
        } else if (!matched && (is_upright || piece.is_solid)) {
          out.against += facing_against(piece, n, area);
        }
      });
  return out;
}

Asked ask_all(const AlignMap& map, const AlignMap& other, const Transform& T, const Eigen::Matrix3d& R_target_other,
              std::size_t pieces, int threads) {
  const SurfaceLevel& surface = other.fine();
  const std::size_t count = std::min(surface.cells().size(), pieces);
  std::vector<Asked> parts(chunks_of(count, kPiecesPerChunk));
  for_each_chunk(threads, parts.size(), [&](std::size_t chunk) {
    const std::size_t begin = chunk * kPiecesPerChunk;
    parts[chunk] = ask(map, surface, T, R_target_other, begin, std::min(count, begin + kPiecesPerChunk), count);
  });
  Asked out;
  for (const Asked& part : parts) out.add(part);
  return out;
}

void collect_against(const AlignMap& map, const AlignMap& other, const Transform& T_map_other,
                     const Transform& T_target_other, bool is_of_source, std::size_t pieces,
                     std::vector<PieceAgainst>& out) {
  const SurfaceLevel& surface = other.fine();
  const std::size_t count = std::min(surface.cells().size(), pieces);
  ask_each(map, surface, T_map_other, T_target_other.linear(), 0, count, count,
           [&](const SurfaceCell& piece, const Eigen::Vector3d&, const Eigen::Vector3d& n, bool is_upright, double area,
               Answer said) {
             if (!is_upright || (said != Answer::kDisplaced && said != Answer::kContradicted)) return;
             out.push_back({T_target_other * piece.mean.cast<double>(), facing_against(piece, n, area), area,
                            said == Answer::kDisplaced, is_of_source});
           });
}

double share(const Verdicts& a, const Verdicts& b) {
  return a.all + b.all > 0.0 ? (a.matched + b.matched) / (a.all + b.all) : 0.0;
}

}  // namespace

void Verdicts::add(const Verdicts& other) {
  all += other.all;
  matched += other.matched;
  displaced += other.displaced;
  contradicted += other.contradicted;
}

Verdicts Support::upright() const {
  Verdicts v = source_upright;
  v.add(target_upright);
  return v;
}

Verdicts Support::level() const {
  Verdicts v = source_level;
  v.add(target_level);
  return v;
}

double Support::overlap_source() const { return share(source_upright, source_level); }
double Support::overlap_target() const { return share(target_upright, target_level); }

double Support::score() const { return upright().matched - kScoreAgainst * upright().against(); }

bool Support::is_contested() const {
  const Eigen::Matrix2d net = matched_facing - kContested * against_facing;
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(net).eigenvalues()[0] <
         -kContested * kContestedShare * upright().matched;
}

Verdicts Support::all() const {
  Verdicts v = upright();
  v.add(level());
  return v;
}

Eigen::Vector2d Support::weak_direction() const {
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(matched_facing).eigenvectors().col(0);
}

Support support(const AlignMap& target, const AlignMap& source, const Transform& T_target_source, std::size_t pieces,
                int threads) {
  const Asked of_source = ask_all(target, source, T_target_source, T_target_source.linear(), pieces, threads);
  const Asked of_target =
      ask_all(source, target, T_target_source.inverse(), Eigen::Matrix3d::Identity(), pieces, threads);
  return {of_source.upright,
          of_source.level,
          of_target.upright,
          of_target.level,
          of_source.matched + of_target.matched,
          of_source.against + of_target.against};
}

std::vector<PieceAgainst> pieces_against(const AlignMap& target, const AlignMap& source,
                                         const Transform& T_target_source, std::size_t pieces) {
  std::vector<PieceAgainst> out;
  collect_against(target, source, T_target_source, T_target_source, true, pieces, out);
  collect_against(source, target, T_target_source.inverse(), Transform::Identity(), false, pieces, out);
  return out;
}

Matrix6 covariance(const GicpResult& result) {
  const double sigma = std::max(result.sigma, kMinSigma);
  const double damping = 1e-9 * std::max(result.hessian.diagonal().maxCoeff(), 1e-9);
  const Matrix6 inverse = (result.hessian + damping * Matrix6::Identity()).ldlt().solve(Matrix6::Identity());
  return sigma * sigma * kPairsPerMeasurement * 0.5 * (inverse + inverse.transpose());
}

}  // namespace concord

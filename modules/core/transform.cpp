#include "core/transform.hpp"

namespace concord {

bool is_rotation(const Eigen::Matrix3d& R) {
  constexpr double kError = 1e-6;
  const double error = (R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  return R.allFinite() && error < kError && R.determinant() > 0;
}

Result<Transform> make_transform(const Eigen::Vector3d& position, const Eigen::Vector4d& xyzw) {
  if (!position.allFinite() || !xyzw.allFinite()) {
    return refuse(Code::kNotFinite, "transform has a component that is not finite");
  }
  if (std::abs(xyzw.norm() - 1.0) > 1e-3) {
    return refuse(Code::kBadTransform,
                  "quaternion has norm " + std::to_string(xyzw.norm()) + "; send a unit quaternion (x y z w)");
  }
  if (position.cwiseAbs().maxCoeff() > kFarthestPlacement) {
    return refuse(Code::kBadTransform, "translation is over 10 km; is it in metres?");
  }
  Transform T = Transform::Identity();
  T.linear() = Eigen::Quaterniond(xyzw[3], xyzw[0], xyzw[1], xyzw[2]).normalized().toRotationMatrix();
  T.translation() = position;
  return T;
}

}  // namespace concord

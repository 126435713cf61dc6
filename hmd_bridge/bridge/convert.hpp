#pragma once

#include <string>

#include "core/corrections.hpp"
#include "core/requests.hpp"
#include "core/shape.hpp"
#include "protocol/messages.hpp"

namespace concord::hmd {

/// Values of the protocol to those of modules/core and back. What comes from outside is checked.

[[nodiscard]] Pose to_hmd(const Transform& T);
[[nodiscard]] Volume to_hmd(const concord::Volume& volume);
[[nodiscard]] Zone to_hmd(const concord::Zone& zone);
[[nodiscard]] Lease to_hmd(const concord::Lease& lease);
[[nodiscard]] Operation to_hmd(const concord::Operation& operation);
[[nodiscard]] Agent to_hmd(const AgentState& agent);
[[nodiscard]] ConflictRegion to_hmd(const concord::ConflictRegion& region);

[[nodiscard]] Result<Transform> from_hmd(const Pose& pose);
/// Refused: what core's `check` refuses.
[[nodiscard]] Result<concord::Shape> from_hmd(const Shape& shape);
[[nodiscard]] Result<concord::Volume> from_hmd(const Volume& volume);
[[nodiscard]] concord::Zone::Kind from_hmd(ZoneKind kind);
[[nodiscard]] concord::Operation::Kind from_hmd(OperationKind kind);

/// The code that a client is told for one of the stack; `name` as it stands in an answer.
[[nodiscard]] Code code_of(const std::string& name);
[[nodiscard]] inline Code code_of(const Error& error) { return code_of(concord::name(error.code)); }

template <std::size_t kSize>
[[nodiscard]] Eigen::Matrix<double, static_cast<int>(kSize), 1> vector_of(const std::array<double, kSize>& values) {
  return Eigen::Map<const Eigen::Matrix<double, static_cast<int>(kSize), 1>>(values.data());
}
[[nodiscard]] inline std::array<double, 3> array_of(const Eigen::Vector3d& p) { return {p.x(), p.y(), p.z()}; }

}  // namespace concord::hmd

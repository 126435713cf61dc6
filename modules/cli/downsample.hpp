#pragma once

#include <vector>

#include <Eigen/Core>

#include "cli/live.hpp"

namespace concord {

/// Asks ingest for a coarse cloud, agent's frame, and again only when no part of it has come for a second: a long
/// answer is on its way for seconds. Fails with what ingest refused it for, kNoAnswer, or kIncomplete.
[[nodiscard]] tl::expected<std::vector<Eigen::Vector3f>, Failure> request_cloud(Live& live,
                                                                                const DownsampleRequest& request);

}  // namespace concord

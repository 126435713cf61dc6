#pragma once

#include <memory>
#include <span>
#include <string>

#include "cli/live.hpp"
#include "client/bridge_client.hpp"
#include "core/lattice.hpp"
#include "core/transform.hpp"

namespace concord {

/// The person of a demo, who works through the headsets' bridge as everybody does, and comes in again after a restart
/// of it.
class DemoPerson {
 public:
  using Step = tl::expected<void, Failure>;

  /// Comes in at the bridge that runs on `live`'s state folder, which must outlive this. Fails with kNoAnswer.
  [[nodiscard]] static tl::expected<std::unique_ptr<DemoPerson>, Failure> enter(Live& live, const std::string& name);

  /// Where a browser of this machine finds the page.
  [[nodiscard]] const std::string& page() const { return page_; }

  /// Fail with what the stack refused it for, or kNoAnswer.
  [[nodiscard]] Step place(const std::string& agent, const Transform& T_map_agent);
  [[nodiscard]] Step add(std::span<const VoxelIndex> voxels, double resolution);

 private:
  DemoPerson(Live& live, std::string name) : live_(live), name_(std::move(name)) {}

  [[nodiscard]] Step come_in();
  /// Asks, and waits for the answer; where the bridge ends meanwhile, of the next one.
  template <class Request>
  [[nodiscard]] Step ask(const Request& request);

  Live& live_;
  std::string name_;
  std::string page_;
  std::unique_ptr<hmd::BridgeClient> client_;
  std::shared_ptr<bool> here_ = std::make_shared<bool>(true);  ///< ends what is done each while
};

}  // namespace concord

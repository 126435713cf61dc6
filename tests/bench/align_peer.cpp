// Built only where small_gicp lies beside the project: nothing of it is in here.
#include <small_gicp/registration/registration_helper.hpp>

#include "align_speed.hpp"

namespace concord::bench {
namespace {

Transform run(small_gicp::RegistrationSetting::RegistrationType type, const Points& target, const Points& source,
              const Transform& guess, int threads) {
  small_gicp::RegistrationSetting setting;  // its own defaults: 0.25 m downsampling, 1 m voxels, 20 iterations
  setting.type = type;
  setting.num_threads = threads;
  return small_gicp::align(target, source, guess, setting).T_target_source;
}

Method method(const std::string& name, small_gicp::RegistrationSetting::RegistrationType type) {
  return {name, [type](const Points& target, const Points& source, const Transform& guess, int threads) {
            return run(type, target, source, guess, threads);
          }};
}

}  // namespace

std::vector<Method> peer_methods() {
  return {method("small_gicp VGICP", small_gicp::RegistrationSetting::VGICP),
          method("small_gicp GICP", small_gicp::RegistrationSetting::GICP)};
}

}  // namespace concord::bench

#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "request.hpp"

namespace concord::soak {

/// Makes up what people ask, of every kind, much of it at the same places: a function of its seed and of what was
/// granted so far.
class Script {
 public:
  explicit Script(std::uint32_t seed) : random_(seed) {}

  /// Places the robots: without it nothing can be seen.
  [[nodiscard]] std::vector<Request> opening();
  [[nodiscard]] Request next(const std::string& author);

  /// So that edits can be undone, zones changed and revisions named.
  void granted(const Request& request, std::int64_t revision);

 private:
  [[nodiscard]] double real(double low, double high) { return std::uniform_real_distribution<>(low, high)(random_); }
  [[nodiscard]] int whole(int low, int high) { return std::uniform_int_distribution<>(low, high)(random_); }
  [[nodiscard]] Eigen::Vector3d place();
  [[nodiscard]] Transform pose();
  [[nodiscard]] Shape shape();
  [[nodiscard]] Volume volume();
  [[nodiscard]] WorkFrame frame();
  [[nodiscard]] std::string new_id();

  [[nodiscard]] Request edit(const std::string& author);
  [[nodiscard]] Request undo(const std::string& author);
  [[nodiscard]] Request zone(const std::string& author);
  [[nodiscard]] Request alignment(const std::string& author);
  [[nodiscard]] Request weight(const std::string& author);
  [[nodiscard]] Request lease(const std::string& author);

  std::mt19937 random_;
  int count_ = 0;
  std::int64_t revision_ = 0;
  std::vector<std::string> edits_;  ///< granted
};

}  // namespace concord::soak

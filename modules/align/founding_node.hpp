#pragma once

#include <filesystem>
#include <optional>

#include "align/align_desk.hpp"
#include "bus/layers_node.hpp"
#include "bus/process.hpp"

namespace concord {

/// Brings the founding of the map to an end, through merge and over restarts: what the desk has begun is kept in the
/// state folder until both halves are done or the first one is taken back.
class FoundingNode {
 public:
  /// Takes up what was under way when the process ended.
  FoundingNode(const NodeContext& context, AlignDesk& desk, LayersNode& layers);

  /// Writes down what is under way, where that has changed. To be called before merge is asked. Refused (kIo).
  [[nodiscard]] Result<void> keep();
  /// Asks merge for the next half.
  void go_on();

 private:
  [[nodiscard]] std::filesystem::path file() const;

  NodeContext context_;
  AlignDesk& desk_;
  LayersNode& layers_;
  std::optional<Bytes> kept_;  ///< in the file
};

}  // namespace concord

#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "bus/messages.hpp"
#include "bus/process.hpp"
#include "bus/replies.hpp"
#include "semantic/labels/labels.hpp"

namespace concord {

/// The labels in saved maps. Merge writes these files: for each that is to be saved the labels are laid beside it
/// before (store/handover.hpp). Of one that is loaded they are looked at with the request, and taken when merge has
/// taken what is its; `core/map_archive.md` says who does what when.
class LabelFilesNode {
 public:
  struct Parts {
    const Labels& labels;
    /// All that was done to them, in its order. Refused: kIo; and what `visit` refuses.
    std::function<Result<void>(const std::function<Result<void>(LabelCorrection)>& visit)> for_each;
    /// Stores and applies all of them, or none. Refused: kIo.
    std::function<Result<void>(const std::vector<LabelCorrection>&)> commit;
  };
  LabelFilesNode(const NodeContext& context, Parts parts);
  LabelFilesNode(const LabelFilesNode&) = delete;
  LabelFilesNode& operator=(const LabelFilesNode&) = delete;

 private:
  void on_request(const MapRequest& request);
  void on_answer(const Answer& answer);
  void hand_over(const MapRequest& request);
  void open(const MapRequest& request);
  void take();
  [[nodiscard]] Result<Bytes> section() const;

  /// A file that is being loaded.
  struct Opened {
    std::string request_id;
    std::vector<LabelCorrection> theirs;
    std::int64_t asked = 0;
    std::int64_t fits = -1;  ///< the revision of ours at which that was found
    bool has_news = false;
  };

  NodeContext context_;
  Parts parts_;
  Replies replies_;
  std::set<std::string> handed_over_;  ///< requests
  std::optional<Opened> opened_;
};

}  // namespace concord

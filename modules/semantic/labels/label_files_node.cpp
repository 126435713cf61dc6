#include "semantic/labels/label_files_node.hpp"

#include <filesystem>

#include "core/map_archive.hpp"
#include "semantic/labels/label_loading.hpp"
#include "semantic/labels/label_section.hpp"
#include "store/handover.hpp"
#include "store/whole_file.hpp"

namespace concord {
namespace {

namespace fs = std::filesystem;

const std::string kRequests = "in/map_request";
const std::string kNative = "concord";
constexpr std::int64_t kKeepOpened = 60'000'000;  ///< long after who loads would have asked again, microseconds
constexpr std::int64_t kForgetPeriod = 10'000'000;

}  // namespace

LabelFilesNode::LabelFilesNode(const NodeContext& context, Parts parts)
    : context_(context), parts_(std::move(parts)), replies_(context) {
  std::error_code nothing_there;
  fs::remove_all(handover_folder(context_.site.state), nothing_there);  // what a kill left
  listen<MapRequest>(context_.bus, context_.counters, context_.process, kRequests,
                     [this](const std::string&, const MapRequest& request) { on_request(request); });
  listen<Answer>(context_.bus, context_.counters, context_.process, kAnswers,
                 [this](const std::string&, const Answer& answer) { on_answer(answer); });
  context_.bus.every(kForgetPeriod, [this] {
    if (opened_ && context_.bus.now() - opened_->asked >= kKeepOpened) opened_.reset();
  });
}

void LabelFilesNode::on_request(const MapRequest& request) {
  if (request.op == MapRequest::Op::kSave && request.names(kNative)) return hand_over(request);
  if (request.op != MapRequest::Op::kLoad) return;
  const fs::path file = context_.site.state / "maps" / (request.map + "." + kNative);
  std::error_code error;
  if (request.names(kNative) || (request.formats.empty() && fs::exists(file, error))) open(request);
}

/// What merge says no to for want of this, it is asked for again.
void LabelFilesNode::hand_over(const MapRequest& request) {
  const auto labels = section();
  if (!labels) return replies_.deny(kRequests, request.id, labels.error());
  const fs::path file = handover_file(context_.site.state, request.id);
  std::error_code error;
  fs::create_directories(file.parent_path(), error);
  if (const auto written = write_whole_file(file, *labels); !written) {
    return replies_.deny(kRequests, request.id, written.error());
  }
  handed_over_.insert(request.id);
}

Result<Bytes> LabelFilesNode::section() const {
  Bytes out;
  const auto read = parts_.for_each([&](const LabelCorrection& correction) -> Result<void> {
    append_label_correction(out, correction);
    if (out.size() <= kMaxArchiveBytes) return {};
    return refuse(Code::kTooLarge, "the labels are more than a map file holds");
  });
  if (!read) return tl::unexpected(read.error());
  return out;
}

/// Whatever could refuse the labels is found out before merge takes anything.
void LabelFilesNode::open(const MapRequest& request) {
  if (!opened_ || opened_->request_id != request.id) {
    opened_.reset();
    const auto file = read_whole_file(context_.site.state / "maps" / (request.map + "." + kNative), kMaxArchiveBytes);
    if (!file) return;  // merge says so
    auto theirs = labels_of_map_archive(*file).and_then([](const Bytes& labels) { return read_label_section(labels); });
    if (!theirs) return replies_.deny(kRequests, request.id, theirs.error());
    opened_ = Opened{request.id, std::move(*theirs)};
  }
  opened_->asked = context_.bus.now();
  if (opened_->fits != parts_.labels.revision()) {  // asked again, nothing is found out twice
    const auto fits = labels_to_load(opened_->theirs, parts_.labels);
    if (!fits) return replies_.deny(kRequests, request.id, fits.error());
    opened_->has_news = !fits->empty();
    opened_->fits = parts_.labels.revision();
  }
  if (!opened_->has_news)
    return replies_.grant(request.id, parts_.labels.revision(), 0, "no label in it that is not here");
  replies_.deny(kRequests, request.id,
                {Code::kBusy, "its labels follow when the map is loaded; ask again in a second"});
}

void LabelFilesNode::on_answer(const Answer& answer) {
  if (answer.process != "merge" || answer.code == name(Code::kBusy)) return;
  if (handed_over_.erase(answer.id) > 0) {
    std::error_code error;
    fs::remove(handover_file(context_.site.state, answer.id), error);
  }
  if (!opened_ || opened_->request_id != answer.id) return;
  if (answer.ok) {
    take();
  } else {
    opened_.reset();
  }
}

/// @pre opened_.
void LabelFilesNode::take() {
  const auto following = labels_to_load(opened_->theirs, parts_.labels);
  const std::string id = opened_->request_id;
  if (!following) return replies_.deny(kRequests, id, following.error());
  if (!following->empty()) {
    if (const auto done = parts_.commit(*following); !done) return replies_.deny(kRequests, id, done.error());
  }
  replies_.grant(id, parts_.labels.revision(), static_cast<std::int64_t>(following->size()), "took over the labels");
}

}  // namespace concord

#include "align/founding_node.hpp"

#include <system_error>
#include <utility>

#include <spdlog/spdlog.h>

#include "bus/messages.hpp"
#include "store/whole_file.hpp"

namespace concord {

FoundingNode::FoundingNode(const NodeContext& context, AlignDesk& desk, LayersNode& layers)
    : context_(context), desk_(desk), layers_(layers) {
  auto bytes = read_whole_file(file(), kMaxFoundingBytes);
  if (!bytes && bytes.error().code == Code::kNotFound) return;
  auto founding = bytes ? founding_of(*bytes) : Result<MapFounding>(tl::unexpected(bytes.error()));
  if (!founding) {
    context_.counters.refused("founding", founding.error());
    spdlog::warn("{}: {}; look who is in the map: concord agents", file().string(), founding.error().message);
    return;
  }
  kept_ = std::move(*bytes);
  desk_.resume(std::move(*founding));
}

std::filesystem::path FoundingNode::file() const { return context_.site.state / "founding"; }

Result<void> FoundingNode::keep() {
  std::optional<Bytes> now;
  if (desk_.founding()) now = to_bytes(*desk_.founding());
  if (now == kept_) return {};
  std::error_code error;
  if (now) {
    std::filesystem::create_directories(context_.site.state, error);  // what is wrong the next line says
    if (auto written = write_whole_file(file(), *now); !written) return written;
  } else if (!std::filesystem::remove(file(), error) && error) {
    return refuse(Code::kIo, "cannot remove " + file().string() + ": " + error.message());
  }
  kept_ = std::move(now);
  return {};
}

void FoundingNode::go_on() {
  const auto is_founded = layers_.map_is_founded();
  if (!is_founded || !layers_.settled()) return;
  const std::int64_t now = context_.bus.now();
  const FoundingStep step = desk_.go_on_founding(layers_.now(), *is_founded, now);
  if (const auto kept = keep(); !kept) return context_.counters.refused("founding", kept.error());
  if (step == FoundingStep::kPlaceTarget) context_.bus.publish("in/transform", encode(desk_.founding()->target, now));
  if (step == FoundingStep::kPlaceSource) context_.bus.publish("in/transform", encode(desk_.founding()->source, now));
  if (step == FoundingStep::kTakeBack) context_.bus.publish("in/undo", encode(take_back(*desk_.founding(), now)));
}

}  // namespace concord

#pragma once

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "bridge/asker.hpp"
#include "bridge/convert.hpp"
#include "bridge/world.hpp"
#include "session/hub.hpp"

namespace concord::hmd {

/// A refusal in the protocol's own words.
struct No {
  Code code;
  std::string message;
};
template <class T>
using Granted = tl::expected<T, No>;
[[nodiscard]] inline tl::unexpected<No> no(Code code, std::string message) {
  return tl::unexpected<No>(No{code, std::move(message)});
}
[[nodiscard]] inline tl::unexpected<No> no(const Error& error) { return no(code_of(error), error.message); }

/// What every request is worked on with, and what more than one kind of request needs.
class Desk {
 public:
  Desk(const NodeContext& node, Hub& clients, World& stack, Asker& asking, std::string models_at)
      : context(node), hub(clients), world(stack), asker(asking), models(std::move(models_at)) {}

  NodeContext context;
  Hub& hub;
  World& world;
  Asker& asker;
  const std::string models;  ///< the address below which NAME.glb is an asset's model

  [[nodiscard]] std::string id(const Ask& ask) const { return asker.id_of(ask.session, ask.id); }
  [[nodiscard]] std::int64_t now() const { return context.bus.now(); }
  /// Who asks; always there while a request of theirs is worked on.
  [[nodiscard]] const std::string& author(const Ask& ask) { return hub.find(ask.session)->identity.name; }
  void refuse(const Ask& ask, const No& why) { hub.refuse(ask, why.code, why.message); }

  /// A frame that a request names: for the stack, and where it lies in the map now.
  struct InMap {
    WorkFrame frame;
    Transform T_map_frame = Transform::Identity();
  };
  [[nodiscard]] Granted<InMap> place(const Ask& ask, Frame frame);
  /// A pose in a frame, as one in the map.
  [[nodiscard]] Granted<Transform> in_map(const Ask& ask, Frame frame, const Pose& pose);

  /// Asks the stack one thing and answers the client with `good(answer)`, or with the refusal. `translate` says what a
  /// code of the stack is called in the answer to this request.
  using Translate = Code (*)(const std::string&);
  template <class Good>
  void forward(const Ask& ask, const std::string& channel, Bytes message, Good good, Translate translate = code_of) {
    asker.ask({channel, std::move(message), id(ask), {}, {}}, [this, ask, good, translate](const Answer& answer) {
      if (!answer.ok) return hub.refuse(ask, translate(answer.code), answer.message);
      hub.answer(ask, good(answer));
    });
  }

  /// A lease is this session's own, under the name that it has there.
  [[nodiscard]] std::string lease_id(const Ask& ask, const std::string& name) const {
    return asker.id_of(ask.session, 0) + "-" + name;
  }

  /// What is shown of a robot for which no path is kept.
  [[nodiscard]] static concord::Path no_path(const std::string& robot);
  /// A path for the client that asked: points at most 0.25 m apart, each with its clearance, in the frame it wants.
  [[nodiscard]] Granted<Path> show(const Ask& ask, const concord::Path& path, Frame frame);
  [[nodiscard]] Granted<Path> show(const Session& session, const concord::Path& path, Frame frame);
  [[nodiscard]] Granted<InMap> place(const Session& session, Frame frame);

  /// Answers in parts, and paths, of our own requests while somebody waits for them; by the request's id.
  std::map<std::string, std::map<std::int32_t, HistoryPart>> history;
  std::map<std::string, std::map<std::int32_t, ConflictList>> conflicts;
  std::map<std::string, std::map<std::int32_t, Downsampled>> points;
  std::map<std::string, MapList> maps;
  std::map<std::string, std::map<std::int32_t, LabelList>> labels;
  std::map<std::string, concord::Path> paths;
  std::set<std::string> watched;  ///< requests whose path or list of maps is waited for

  std::shared_ptr<void> alignments;  ///< what requests_align.cpp keeps of what align says

  /// Where an agent was before this session placed it: for align_undo.
  struct Placed {
    std::string frame_id;
    Transform before, after;
  };
  std::map<std::pair<std::int64_t, std::string>, Placed> placed;
};

template <class Part>
[[nodiscard]] bool all_there(const std::map<std::string, std::map<std::int32_t, Part>>& parts, const std::string& id) {
  const auto it = parts.find(id);
  return it != parts.end() && !it->second.empty() &&
         it->second.begin()->second.parts == static_cast<std::int32_t>(it->second.size());
}

}  // namespace concord::hmd

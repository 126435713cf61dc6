// label: what people say of parts of the map.

#include <memory>
#include <optional>

#include "bus/messages_label.hpp"
#include "cli/arguments.hpp"
#include "cli/label_list.hpp"
#include "cli/report.hpp"
#include "cli/selection_options.hpp"
#include "cli/semantic_commands.hpp"
#include "core/touch.hpp"

namespace concord {
namespace {

using Op = LabelRequest::Op;

struct Options {
  std::string op, subject, to, seed, author, id;
  std::uint32_t instance = 0, to_instance = 0;
  SelectionOptions selection;
};

const std::map<std::string, Op>& ops() {
  static const std::map<std::string, Op> all{
      {"add", Op::kLabel},     {"rename", Op::kRename}, {"reassign", Op::kReassign}, {"take-off", Op::kTakeOff},
      {"delete", Op::kDelete}, {"undo", Op::kUndo},     {"redo", Op::kRedo}};
  return all;
}

tl::expected<void, Failure> fill(const Options& options, Live& live, LabelRequest& request) {
  if (request.op == Op::kUndo || request.op == Op::kRedo) {
    request.correction_id = options.subject;
    return {};
  }
  request.of.instance = options.instance;
  request.to_instance = options.to_instance;
  if (request.op != Op::kLabel) {
    const auto label = class_called(live, options.subject);
    if (!label) return tl::unexpected(label.error());
    request.of.label = *label;
    request.name = options.to;
    return {};
  }
  request.name = options.subject;
  if (is_given(options.selection) == !options.seed.empty()) {
    return fail(Exit::kUnusable, "BAD_REQUEST", "label add needs one shape, or --seed");
  }
  if (options.seed.empty()) {
    auto shape = shape_of(options.selection, live.site().resolution);
    if (!shape) return fail(shape.error());
    request.shape = std::move(*shape);
    request.frame = options.selection.frame;
    return {};
  }
  const auto p = parse_vector(options.seed);
  if (!p) return fail(p.error());
  request.op = Op::kTouch;
  request.shape = touch_at(*p);
  request.frame = options.selection.frame;
  return {};
}

Outcome label(const Options& options, const Common& common) {
  Live live(common);
  if (const auto taken = live.take_resolution(); !taken) return tl::unexpected(taken.error());
  LabelRequest request;
  request.id = live.id_or_new(options.id);
  request.author = author_or_user(options.author);
  request.op = ops().at(options.op);
  request.utime = live.bus().now();
  if (const auto filled = fill(options, live, request); !filled) return tl::unexpected(filled.error());
  const auto made = std::make_shared<std::optional<LabelInstance>>();
  live.hear<LabelList>("out/label_list", [made, id = request.id](const std::string&, const LabelList& list) {
    if (list.id == id && !list.instances.empty()) *made = list.instances.front();
  });
  const auto answer = live.ask("in/label", request);
  if (!answer) return tl::unexpected(answer.error());
  nlohmann::json object = to_json(*answer);
  if (*made) object["instance"] = to_json(**made, live.site().resolution);
  common.print(object, answer->process + ": " + answer->message + "\nid " + answer->id);
  return Exit::kDone;
}

}  // namespace

void add_label(Program& program) {
  auto options = std::make_shared<Options>();
  CLI::App& command = program.add("label", "says what parts of the map are",
                                  [options](const Common& common) { return label(*options, common); });
  std::vector<std::string> words;
  for (const auto& [word, op] : ops()) words.push_back(word);
  command
      .add_option("op", options->op,
                  "add; rename, reassign; take-off leaves the voxels, delete takes them from the map; undo, redo")
      ->required()
      ->check(CLI::IsMember(words));
  command.add_option("subject", options->subject, "name of the class; with undo and redo the id of a label request")
      ->required();
  command.add_option("instance", options->instance,
                     "number of the instance; without it a new one (add), or all of the class (take-off, delete)");
  command.add_option("--as", options->to, "rename: the new name; reassign: the class it is of");
  command.add_option("--as-instance", options->to_instance, "reassign: its number there; without it a new one");
  command.add_option("--seed", options->seed, "\"x y z\": one touch, the object there; see concord segment");
  add_shape_options(command, options->selection);
  command.add_option("--author", options->author, "who asks; without it $USER");
  command.add_option("--id", options->id, "of this request: asked again with it, it is done once");
}

}  // namespace concord

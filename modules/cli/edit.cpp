// edit, undo, redo: what people pin above every sensor.

#include <memory>

#include "cli/arguments.hpp"
#include "cli/extent.hpp"
#include "cli/history.hpp"
#include "cli/live.hpp"
#include "cli/numbers.hpp"
#include "cli/report.hpp"
#include "cli/selection_options.hpp"
#include "core/text.hpp"

namespace concord {
namespace {

/// Merge's words, and by what the edit can be found again.
std::string to_words(const Answer& answer) {
  return answer.process + ": " + answer.message + "\nid " + answer.id + ", " + format_count(answer.count) +
         (answer.count == 1 ? " voxel" : " voxels") + ", revision " + std::to_string(answer.revision);
}

struct Options {
  std::string op, move, author, id;
  SelectionOptions selection;
  std::int64_t base_revision = kAnyRevision;
};

struct UndoOptions {
  std::string edit, author, id;
};

EditRequest::Op op_of(const std::string& word) {
  if (word == "add") return EditRequest::Op::kAdd;
  return word == "delete" ? EditRequest::Op::kDelete : EditRequest::Op::kMove;
}

Result<Eigen::Vector3d> move_of(const Options& options) {
  if ((options.op == "move") == options.move.empty()) {
    return refuse(Code::kBadRequest, "edit move needs --move \"dx dy dz\", and nothing else does");
  }
  if (options.move.empty()) return Eigen::Vector3d::Zero().eval();
  return parse_vector(options.move);
}

/// As merge keeps it. Absent: it has not said so in time, which does not undo the edit.
std::optional<Operation> request_made(Live& live, const Answer& answer) {
  HistoryRequest request;
  request.after_revision = answer.revision - 1;
  const auto made = request_history(live, request, 1);
  if (!made || made->empty() || made->front().id != answer.id) return std::nullopt;
  return made->front();
}

/// Where the pins are is said in any case: corners may be given in any order and frame, and voxels in indices.
void print_edit(const Answer& answer, const std::optional<Operation>& made, double resolution, const Common& common) {
  nlohmann::json object = to_json(answer);
  std::string words = to_words(answer);
  object["bounds"] = nullptr;
  if (made) {
    const Box bounds = extent(made->min, made->max, resolution);
    object["bounds"] = to_json(bounds);
    words += "\nx, y, z: " + to_words(bounds) + " m";
  }
  common.print(object, words);
}

/// Whatever an edit was called, it can be taken back.
Result<void> check_edit_id(const std::string& id) {
  if (is_kept_id(id)) return {};
  return refuse(Code::kBadName, std::string("an edit's id is ") + kKeptIdRule);
}

Outcome edit(const Options& options, const Common& common) {
  if (const auto fine = check_own_id(options.id); !fine) return fail(fine.error());
  const auto move = move_of(options);
  if (!move) return fail(move.error());
  auto shape = shape_of(options.selection, common.site().resolution);
  if (!shape) return fail(shape.error());
  Live live(common);
  if (auto* voxels = std::get_if<VoxelList>(&*shape)) {  // they are the map's, whose resolution only the stack knows
    if (const auto taken = live.take_resolution(); !taken) return tl::unexpected(taken.error());
    voxels->resolution = live.site().resolution;
  }
  EditRequest request;
  request.id = live.id_or_new(options.id);
  request.author = author_or_user(options.author);
  request.op = op_of(options.op);
  request.shape = std::move(*shape);
  request.frame = options.selection.frame;
  request.move = *move;
  request.base_revision = options.base_revision;
  request.utime = live.bus().now();
  const auto answer = live.ask("in/edit", request);
  if (!answer) return tl::unexpected(answer.error());
  auto made = request_made(live, *answer);
  if (!live.take_resolution()) made.reset();
  print_edit(*answer, made, live.site().resolution, common);
  return Exit::kDone;
}

Outcome undo(const UndoOptions& options, bool redo, const Common& common) {
  const auto fine = check_edit_id(options.edit).and_then([&] { return check_own_id(options.id); });
  if (!fine) return fail(fine.error());
  Live live(common);
  const UndoRequest request{live.id_or_new(options.id), author_or_user(options.author), options.edit, redo,
                            live.bus().now()};
  return print_revision(live.ask("in/undo", request), common);
}

void add_undo(Program& program, const std::string& name, const std::string& what, bool redo) {
  auto options = std::make_shared<UndoOptions>();
  CLI::App& command =
      program.add(name, what, [options, redo](const Common& common) { return undo(*options, redo, common); });
  command.add_option("edit", options->edit, "the edit's id; concord history lists them")->required();
  command.add_option("--author", options->author, "who asks; without it $USER");
  command.add_option("--id", options->id, "of this request: asked again with it, it is done once");
}

}  // namespace

void add_edit(Program& program) {
  auto options = std::make_shared<Options>();
  CLI::App& pin = program.add("edit", "pins voxels of the map, above every sensor",
                              [options](const Common& common) { return edit(*options, common); });
  pin.add_option("op", options->op, "add pins occupied, delete pins free, move takes what is occupied elsewhere")
      ->required()
      ->check(CLI::IsMember({"add", "delete", "move"}));
  add_shape_options(pin, options->selection);
  pin.add_option("--move", options->move, "\"dx dy dz\": how far, with move; whole voxels of the map are moved");
  pin.add_option("--base-revision", options->base_revision,
                 "the revision that was seen: refused if these voxels were changed since")
      ->check(CLI::NonNegativeNumber);
  pin.add_option("--author", options->author, "who edits; without it $USER");
  pin.add_option("--id", options->id, "of the edit: asked again with it, it is done once");

  add_undo(program, "undo", "takes an edit back, whatever came after it", false);
  add_undo(program, "redo", "brings an edit back that was undone", true);
}

}  // namespace concord

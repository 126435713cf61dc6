// Where one map lies in another: of two files, or of what the running stack holds.

#include <filesystem>
#include <memory>

#include "cli/align_files.hpp"
#include "cli/align_live.hpp"
#include "cli/arguments.hpp"

namespace concord {
namespace {

struct Options {
  std::string source, target, guess, picture, author, id;
  bool from_files = false, accept = false;
};

struct Decision {
  std::string op, align_id, author, id;
};

/// What is sure to fail is said before minutes are spent. Refused (kNotFound).
Result<void> check_picture(const std::filesystem::path& picture) {
  const std::filesystem::path folder = picture.parent_path();
  std::error_code error;
  if (folder.empty() || std::filesystem::is_directory(folder, error)) return {};
  return refuse(Code::kNotFound, folder.string() + ": there is no such folder to write the picture into");
}

Outcome run_align(const Options& options, const Common& common) {
  if (const auto can = check_picture(options.picture); !can) return fail(can.error());
  std::optional<Transform> guess;
  if (!options.guess.empty()) {
    const auto T = parse_transform(options.guess);
    if (!T) return fail(T.error());
    guess = *T;
  }
  if (!options.from_files && !is_alignable_file(options.source) && !is_alignable_file(options.target)) {
    return align_live(
        {options.source, options.target, guess, options.accept, options.picture, options.author, options.id}, common);
  }
  if (options.target.empty() || options.accept || !options.author.empty() || !options.id.empty()) {
    return fail(Exit::kUnusable, "USAGE", "of files there are two, and nothing to accept; see concord align --help");
  }
  return align_files({options.source, options.target, guess, options.picture}, common);
}

}  // namespace

void add_align(Program& program) {
  auto options = std::make_shared<Options>();
  CLI::App& command = program.add("align", "where one map lies in another, with what speaks for it and against it",
                                  [options](const Common& common) { return run_align(*options, common); });
  command.add_option("source", options->source, "an agent, or a file: .bt, .ot, .pcd or .ply")->required();
  command.add_option("target", options->target,
                     "another agent or file; without it the map, as the other agents make it");
  command
      .add_option("--guess", options->guess,
                  "T_target_source as \"x y z qx qy qz qw\", within 2 m and 45 degrees of yaw; without it the source "
                  "is looked for everywhere")
      ->check([](const std::string& text) { return text.empty() ? "it is empty" : ""; });
  command.add_flag("--from-files", options->from_files, "both are files; so they are where their names say it");
  command.add_option("--picture", options->picture, "writes a PNG: both from above, before and after");
  command.add_flag("--accept", options->accept, "puts the agent there if it is found");
  command.add_option("--author", options->author, "who asks; without it $USER");
  command.add_option("--id", options->id, "of this request: asked again with it, it is done once");

  auto decision = std::make_shared<Decision>();
  CLI::App& word =
      program.add("alignment", "puts an agent where it was found, or drops that", [decision](const Common& common) {
        return decide_alignment(decision->align_id, decision->op == "accept", decision->author, decision->id, common);
      });
  word.add_option("op", decision->op, "accept or drop; drop also cancels a request that waits")
      ->required()
      ->check(CLI::IsMember({"accept", "drop"}));
  word.add_option("alignment", decision->align_id, "its id; concord alignments lists them")->required();
  word.add_option("--author", decision->author, "who decides; without it $USER");
  word.add_option("--id", decision->id, "of the placement, by which it can be undone");

  program.add("alignments", "what was found and can be accepted, and who has slipped", list_alignments);
}

}  // namespace concord

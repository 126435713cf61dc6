// Where one map lies in another: of two files, or of what the running stack holds.

#include <memory>

#include "cli/align_files.hpp"
#include "cli/arguments.hpp"

namespace concord {
namespace {

struct Options {
  std::string source, target, guess, picture;
};

Outcome run_align(const Options& options, const Common& common) {
  std::optional<Transform> guess;
  if (!options.guess.empty()) {
    const auto T = parse_transform(options.guess);
    if (!T) return fail(T.error());
    guess = *T;
  }
  return align_files({options.source, options.target, guess, options.picture}, common);
}

}  // namespace

void add_align(Program& program) {
  auto options = std::make_shared<Options>();
  CLI::App& command = program.add("align", "where one map lies in another, with what speaks for it and against it",
                                  [options](const Common& common) { return run_align(*options, common); });
  command.add_option("source", options->source, ".bt, .ot, .pcd or .ply")->required();
  command.add_option("target", options->target, "the same")->required();
  command.add_option(
      "--guess", options->guess,
      "T_target_source as \"x y z qx qy qz qw\", within 2 m and 45 degrees of yaw; without it the source "
      "is looked for everywhere");
  command.add_option("--picture", options->picture, "writes a PNG: both from above, before and after");
}

}  // namespace concord

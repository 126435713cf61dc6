// asset: models of the server's folder, put into the map.

#include <memory>

#include "bus/messages_asset.hpp"
#include "cli/arguments.hpp"
#include "cli/list_copy.hpp"
#include "cli/numbers.hpp"
#include "cli/report.hpp"
#include "cli/semantic_commands.hpp"
#include "cli/table.hpp"

namespace concord {
namespace {

struct Options {
  std::string op, asset, transform = "0 0 0 0 0 0 1", author, id;
};

Outcome list(const Common& common) {
  Live live(common);
  ListCopy<Asset> copy(live, "out/assets");
  const auto assets = copy.wait_synced(live);
  if (!assets) return tl::unexpected(assets.error());
  nlohmann::json all = nlohmann::json::array();
  std::vector<std::vector<std::string>> rows;
  for (const Asset& asset : *assets) {
    all.push_back({{"name", asset.name}, {"class", asset.class_name}, {"file", asset.file}, {"unit", asset.unit}});
    rows.push_back({asset.name, asset.class_name, asset.file, format_number(asset.unit, 4)});
  }
  common.print({{"assets", all}},
               rows.empty() ? "there is no asset; see modules/semantic/README.md" : format_table(rows, "lllr"));
  return Exit::kDone;
}

Outcome inject(const Options& options, const Common& common) {
  if (!is_name(options.asset)) return bad_name(options.asset);
  const auto T = parse_transform(options.transform);
  if (!T) return fail(T.error());
  Live live(common);
  const AssetRequest request{live.id_or_new(options.id), author_or_user(options.author), options.asset, *T,
                             live.bus().now()};
  return print_revision(live.ask("in/asset", request), common);
}

}  // namespace

void add_assets(Program& program) {
  auto options = std::make_shared<Options>();
  CLI::App& command = program.add(
      "asset", "models that the server keeps, put into the map",
      [options](const Common& common) { return options->op == "list" ? list(common) : inject(*options, common); });
  command.add_option("op", options->op, "list, or inject: occupied and labelled, until its edit is undone")
      ->required()
      ->check(CLI::IsMember({"list", "inject"}));
  command.add_option("asset", options->asset, "its name, with inject");
  command.add_option("--transform", options->transform, "T_map_asset as \"x y z qx qy qz qw\", of the file's own axes");
  command.add_option("--author", options->author, "who asks; without it $USER");
  command.add_option("--id", options->id,
                     "of this request: asked again with it, it is done once; its edit is asset-ID");
}

}  // namespace concord

// asset: models of the server's folder, put into the map.

#include <array>
#include <memory>

#include "bus/messages_asset.hpp"
#include "cli/arguments.hpp"
#include "cli/label_list.hpp"
#include "cli/list_copy.hpp"
#include "cli/numbers.hpp"
#include "cli/report.hpp"
#include "cli/semantic_commands.hpp"
#include "cli/table.hpp"

namespace concord {
namespace {

struct Options {
  std::string op, subject, transform, author, id;
  std::uint32_t instance = 0;
};

/// It is not known before the model has been read; one that cannot be read has none.
std::string words_of_size(const Asset& asset) {
  if (asset.size.isZero()) return "no size yet, or not readable: see concord status";
  return format_number(asset.size.x(), 2) + " x " + format_number(asset.size.y(), 2) + " x " +
         format_number(asset.size.z(), 2) + " m";
}

Outcome list(const Common& common) {
  Live live(common);
  ListCopy<Asset> copy(live, "semantic", "out/assets");
  const auto assets = copy.wait_synced(live);
  if (!assets) return tl::unexpected(assets.error());
  nlohmann::json all = nlohmann::json::array();
  std::vector<std::vector<std::string>> rows;
  for (const Asset& asset : *assets) {
    all.push_back({{"name", asset.name},
                   {"class", asset.class_name},
                   {"file", asset.file},
                   {"unit", asset.unit},
                   {"size", std::array<double, 3>{asset.size.x(), asset.size.y(), asset.size.z()}},
                   {"gltf_bytes", asset.gltf_bytes}});
    rows.push_back({asset.name, asset.class_name, asset.file, format_number(asset.unit, 4), words_of_size(asset)});
  }
  common.print({{"assets", all}},
               rows.empty() ? "there is no asset; see modules/semantic/README.md" : format_table(rows, "lllrl"));
  return Exit::kDone;
}

tl::expected<AssetRequest, Failure> request_of(const Options& options, Live& live) {
  AssetRequest request;
  request.author = author_or_user(options.author);
  if (options.op == "inject") {
    if (!is_name(options.subject)) return bad_name(options.subject);
    request.asset = options.subject;
  } else {
    request.op = options.op == "move" ? AssetRequest::Op::kMove : AssetRequest::Op::kDelete;
    if (options.instance == 0) {
      request.of = options.subject;
    } else {
      const auto label = class_called(live, options.subject);
      if (!label) return tl::unexpected(label.error());
      request.instance = {*label, options.instance};
    }
  }
  if (options.op == "delete") return request;
  if (options.transform.empty()) {
    return fail(Exit::kUnusable, "BAD_REQUEST", options.op + " needs --transform: where it is to lie");
  }
  const auto T = parse_transform(options.transform);
  if (!T) return fail(T.error());
  request.T_map_asset = *T;
  return request;
}

Outcome ask(const Options& options, const Common& common) {
  Live live(common);
  auto request = request_of(options, live);
  if (!request) return tl::unexpected(request.error());
  request->id = live.id_or_new(options.id);
  request->utime = live.bus().now();
  return print_revision(live.ask("in/asset", *request), common);
}

}  // namespace

void add_assets(Program& program) {
  auto options = std::make_shared<Options>();
  CLI::App& command = program.add(
      "asset", "models that the server keeps, put into the map",
      [options](const Common& common) { return options->op == "list" ? list(common) : ask(*options, common); });
  command.add_option("op", options->op, "list; inject: occupied and labelled; move and delete what was injected")
      ->required()
      ->check(CLI::IsMember({"list", "inject", "move", "delete"}));
  command.add_option("subject", options->subject,
                     "inject: name of the asset; move, delete: id of its injection, or its class with a number");
  command.add_option("instance", options->instance, "move, delete: number of the instance of that class");
  command.add_option("--transform", options->transform, "T_map_asset as \"x y z qx qy qz qw\", of the file's own axes");
  command.add_option("--author", options->author, "who asks; without it $USER");
  command.add_option("--id", options->id,
                     "of this request: asked again with it, it is done once; its edit is asset-ID");
}

}  // namespace concord

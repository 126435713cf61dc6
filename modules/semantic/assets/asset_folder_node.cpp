#include "semantic/assets/asset_folder_node.hpp"

#include <algorithm>
#include <utility>

#include "semantic/assets/asset_folder.hpp"

namespace concord {
namespace {

constexpr std::int64_t kPeriod = 1'000'000;

}  // namespace

AssetFolderNode::AssetFolderNode(const NodeContext& context, std::launch how)
    : context_(context),
      conversions_(context.bus, how),
      gltf_(context.site.state / "assets"),
      list_(context.bus, context.counters, "out/assets", context.site.stream.bytes_per_second) {
  list();
  context_.bus.every(kPeriod, [this] {
    list();
    write_gltf();
  });
}

void AssetFolderNode::list() {
  auto read = read_asset_folder(context_.site.state / "assets");
  if (!read) read = AssetFolder{assets_, {read.error()}};  // what it was, until it is one again
  if (!std::ranges::equal(read->bad, bad_entries_, {}, &Error::message, &Error::message)) {
    for (const Error& error : read->bad) context_.counters.refused("assets", error);
    bad_entries_ = std::move(read->bad);
  }
  assets_ = std::move(read->assets);
  std::vector<Asset> all;
  for (auto& [name, asset] : assets_) {
    asset.gltf_bytes = gltf_.bytes_of(asset);
    asset.size = gltf_.size_of(asset);
    all.push_back(asset);
  }
  list_.set(all);
}

void AssetFolderNode::write_gltf() {
  if (!conversions_.is_idle()) return;
  const auto count = [this](const Result<void>& done) {
    if (!done) context_.counters.refused("assets", done.error());
  };
  count(gltf_.keep_only(assets_));
  const Asset* asset = gltf_.next(assets_, context_.bus.now());
  if (asset == nullptr) return;
  conversions_.add(gltf_.work_for(*asset),
                   [this, count, name = asset->name, source = gltf_.source_of(*asset)](const Result<Bytes>& reply) {
                     count(gltf_.note(name, source, reply, context_.bus.now()));
                   });
}

}  // namespace concord

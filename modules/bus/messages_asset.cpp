// Translators of assets: core/assets.hpp.

#include "bus/messages_asset.hpp"

#include <cmath>

#include <concord/asset_request_t.hpp>
#include <concord/assets_t.hpp>

#include "bus/translate_list.hpp"
#include "bus/translate_shape.hpp"

namespace concord {
namespace {

using wire::bad;

constexpr std::int64_t kFileLength = 200;

Result<std::string> name_of(const std::string& name) {
  if (is_name(name)) return name;
  return refuse(Code::kBadName, std::string("an asset's name must be ") + kNameRule);
}

std::int8_t to_wire(AssetRequest::Op op) {
  switch (op) {
    case AssetRequest::Op::kInject: return asset_request_t::INJECT;
    case AssetRequest::Op::kMove: return asset_request_t::MOVE;
    case AssetRequest::Op::kDelete: return asset_request_t::DELETE;
  }
  return 0;
}

Result<AssetRequest::Op> op_of(std::int8_t op) {
  switch (op) {
    case asset_request_t::INJECT: return AssetRequest::Op::kInject;
    case asset_request_t::MOVE: return AssetRequest::Op::kMove;
    case asset_request_t::DELETE: return AssetRequest::Op::kDelete;
    default: return refuse(Code::kBadRequest, "op must be INJECT, MOVE or DELETE");
  }
}

Result<std::string> empty(const std::string& text, const char* why) {
  if (text.empty()) return text;
  return refuse(Code::kBadRequest, why);
}

Result<std::string> injection_of(const std::string& id) {
  if (is_request_id(id)) return id;
  return refuse(Code::kBadRequest, std::string("of must be ") + kIdRule);
}

Result<InstanceId> instance_of(std::int32_t label, std::int32_t instance) {
  if (label > 0 && instance > 0) return InstanceId{static_cast<ClassId>(label), static_cast<std::uint32_t>(instance)};
  return refuse(Code::kBadRequest, "say what is meant: of, or the numbers of an instance, which count from 1");
}

asset_t to_wire(const Asset& asset) {
  asset_t out{};
  out.name = asset.name;
  out.class_name = asset.class_name;
  out.file = asset.file;
  out.unit = asset.unit;
  out.gltf_bytes = asset.gltf_bytes;
  for (int i = 0; i < 3; ++i) out.size[i] = asset.size[i];
  return out;
}

Decoded<Asset> from_wire(const asset_t& in) {
  wire::Filling<Asset> out({}, {});
  out.take(&Asset::name, name_of(in.name));
  out.take(&Asset::class_name, wire::title_of(in.class_name));
  if (!is_printable(in.file)) out.require(refuse(Code::kBadName, "an asset's file has a name that is none"));
  out.take(&Asset::file, Result<std::string>(in.file));
  if (!(in.unit > 0) || !std::isfinite(in.unit)) out.require(refuse(Code::kNotFinite, "an asset's unit is none"));
  out.take(&Asset::unit, Result<double>(in.unit));
  out.take(&Asset::gltf_bytes, wire::not_negative(in.gltf_bytes, "gltf_bytes"));
  const Eigen::Vector3d size(in.size[0], in.size[1], in.size[2]);
  if (!size.allFinite() || size.minCoeff() < 0) out.require(refuse(Code::kNotFinite, "an asset's size is none"));
  out.take(&Asset::size, Result<Eigen::Vector3d>(size));
  return out.done();
}

}  // namespace

Bytes encode(const AssetRequest& value) {
  auto out = wire::asked_by<asset_request_t>(value, value.utime);
  out.op = to_wire(value.op);
  out.asset = value.asset;
  out.of = value.of;
  out.label = static_cast<std::int32_t>(value.instance.label);
  out.instance = static_cast<std::int32_t>(value.instance.instance);
  out.T_map_asset = wire::to_wire(value.T_map_asset);
  return wire::to_bytes(out);
}

template <>
Decoded<AssetRequest> decode<AssetRequest>(std::span<const std::uint8_t> bytes) {
  static constexpr WireField kLayout[] = {record(wire::kAsker), fixed(1), text(wire::kNameLength),
                                          text(wire::kIdLength), fixed(4 + 4 + wire::kTransformBytes)};
  const auto in = wire::read_asked<asset_request_t>(bytes, kLayout);
  if (!in) return tl::unexpected(in.error());
  auto out = wire::asked_by<AssetRequest>(*in);
  if (in->request_id.size() > kMostAssetId)
    out.require(refuse(Code::kBadRequest, "request id must be at most " + std::to_string(kMostAssetId) + " bytes"));
  out.take(&AssetRequest::op, op_of(in->op));
  const bool injects = in->op == asset_request_t::INJECT;
  out.take(&AssetRequest::asset, injects ? name_of(in->asset) : empty(in->asset, "asset is for INJECT"));
  const bool by_number = !injects && in->of.empty();
  if (by_number) out.take(&AssetRequest::instance, instance_of(in->label, in->instance));
  if (!by_number && (in->label != 0 || in->instance != 0)) {
    out.require(refuse(Code::kBadRequest, "label and instance are for MOVE and DELETE without of"));
  }
  if (!by_number) {
    out.take(&AssetRequest::of, injects ? empty(in->of, "of is for MOVE and DELETE") : injection_of(in->of));
  }
  out.take(&AssetRequest::T_map_asset, wire::from_wire(in->T_map_asset));
  return out.done();
}

Bytes encode(const ListPart<Asset>& value, std::int64_t utime) {
  return wire::write_list(value, utime, &assets_t::assets, to_wire);
}

template <>
Decoded<ListPart<Asset>> decode<ListPart<Asset>>(std::span<const std::uint8_t> bytes) {
  static constexpr WireField kAsset[] = {text(wire::kNameLength), text(wire::kTitleLength), text(kFileLength),
                                         fixed(8 + 8 + 8 * 3)};
  return wire::read_list<Asset>(bytes, &assets_t::assets, kAsset, static_cast<std::int64_t>(kMaxAssets), from_wire);
}

}  // namespace concord

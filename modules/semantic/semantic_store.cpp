#include "semantic/semantic_store.hpp"

#include <cmath>

#include "bus/site.hpp"
#include "core/decimal.hpp"
#include "core/map_archive_fields.hpp"
#include "semantic/labels/label_section.hpp"
#include "semantic/semantic_schema.hpp"
#include "store/site_resolution.hpp"

namespace concord {
namespace {

tl::unexpected<Error> damaged(const std::string& what) {
  return refuse(Code::kIo, "semantic.db: " + what + "; move the file away and bring back a backup");
}

}  // namespace

SemanticStore::SemanticStore(const std::filesystem::path& file, double resolution)
    : database_(file, kSemanticSchema),
      put_(database_.prepare("INSERT INTO corrections VALUES (?,?,?)")),
      place_(database_.prepare("INSERT OR REPLACE INTO placements VALUES (?,?,?)")),
      spend_(database_.prepare("UPDATE thing_numbers SET spent = spent + ? RETURNING spent")),
      asked_(database_.prepare("SELECT content FROM deletions WHERE id = ?")),
      delete_(database_.prepare("INSERT INTO deletions VALUES (?,?)")) {
  Statement count = database_.prepare("SELECT COUNT(*) FROM deletions");
  count.bind();
  if (const auto row = count.step(); row && *row) deletions_ = static_cast<std::size_t>(count.integer(0));
  const double kept = kept_resolution(database_, resolution);
  if (std::abs(kept - resolution) <= 1e-9) return;
  throw ConfigError("the labels in this state folder are for " + decimal(kept) +
                    " m voxels; set resolution to that, or start with another state folder");
}

Result<void> SemanticStore::put(const LabelCorrection& correction) {
  Bytes bytes;
  append_label_correction(bytes, correction);
  return put_.run(correction.revision, correction.id, ByteSpan(bytes));
}

Result<void> SemanticStore::put(std::span<const LabelCorrection> corrections) {
  auto transaction = Transaction::begin(database_);
  if (!transaction) return tl::unexpected(transaction.error());
  for (const LabelCorrection& correction : corrections) {
    if (const auto stored = put(correction); !stored) return stored;
  }
  return transaction->commit();
}

Result<void> SemanticStore::put(const LabelAnchor& placed) {
  Bytes bytes;
  archive::append_transform(bytes, placed.T_map_agent);
  return place_.run(placed.agent, placed.frame_id, ByteSpan(bytes));
}

Result<std::int64_t> SemanticStore::take_thing_numbers(std::int64_t count) {
  spend_.bind(count);
  std::int64_t spent = 0;
  const auto done = spend_.for_each_row([&] { spent = spend_.integer(0); });
  if (!done) return tl::unexpected(done.error());
  return spent - count + 1;
}

Result<bool> SemanticStore::was_asked(const std::string& deletion_id, std::uint64_t content) {
  asked_.bind(deletion_id);
  std::optional<std::int64_t> before;
  const auto done = asked_.for_each_row([&] { before = asked_.integer(0); });
  asked_.reset();
  if (!done) return tl::unexpected(done.error());
  if (before && *before != static_cast<std::int64_t>(content)) {
    return refuse(Code::kExists, "another deletion had this id; ids must be unique");
  }
  return before.has_value();
}

Result<void> SemanticStore::put_deletion(const std::string& id, std::uint64_t content) {
  if (deletions_ >= kMaxLabelCorrections) return refuse(Code::kTooLarge, "no more deletions are kept");
  return delete_.run(id, static_cast<std::int64_t>(content)).map([&] { ++deletions_; });
}

Result<void> SemanticStore::for_each(const std::function<Result<void>(LabelCorrection)>& visit) {
  Statement rows = database_.prepare("SELECT correction FROM corrections ORDER BY revision");
  for (;;) {
    const Result<bool> more = rows.step();
    if (!more) return tl::unexpected(more.error());
    if (!*more) return {};
    ByteSpan bytes = rows.bytes(0);
    auto correction = read_label_correction(bytes);
    if (!correction || !bytes.empty()) return damaged("a label correction is none");
    if (const auto visited = visit(std::move(*correction)); !visited) return visited;
  }
}

Result<std::vector<LabelAnchor>> SemanticStore::placements() {
  Statement rows = database_.prepare("SELECT agent, frame_id, T_map_agent FROM placements ORDER BY agent, frame_id");
  std::vector<LabelAnchor> out;
  for (;;) {
    const Result<bool> more = rows.step();
    if (!more) return tl::unexpected(more.error());
    if (!*more) return out;
    archive::FieldReader in(rows.bytes(2));
    const Transform T = archive::read_transform(in);
    if (!in.ok() || !is_rotation(T.linear())) return damaged("a placement is none");
    out.push_back({rows.text(0), rows.text(1), T});
  }
}

}  // namespace concord

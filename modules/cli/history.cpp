#include "cli/history.hpp"

#include <algorithm>

#include "cli/extent.hpp"
#include "cli/numbers.hpp"
#include "cli/parts.hpp"
#include "cli/table.hpp"
#include "cli/times.hpp"

namespace concord {
namespace {

/// Few enough that a page arrives in some tens of parts, of which lost ones are soon repeated.
constexpr std::int64_t kPage = 1000;

Box extent(const Operation& operation, double resolution) { return extent(operation.min, operation.max, resolution); }

/// A field of RFC 4180.
std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string field = "\"";
  for (const char c : text) field += c == '"' ? std::string("\"\"") : std::string(1, c);
  return field + "\"";
}

}  // namespace

std::string word_for(Operation::Kind kind) {
  std::string word(name(kind));
  std::ranges::replace(word, '_', '-');
  return word;
}

tl::expected<std::vector<Operation>, Failure> request_history(Live& live, HistoryRequest request, std::int64_t most) {
  std::vector<Operation> all;
  for (;;) {
    const std::int64_t left = most - static_cast<std::int64_t>(all.size());
    const std::int64_t page = std::min(left, kPage);
    if (page == 0) return all;
    request.id = live.new_id();
    request.most = static_cast<int>(page);
    const auto parts =
        ask_in_parts<HistoryPart>(live, Respondent{"in/history_request", "merge", "out/history"}, request);
    if (!parts) return tl::unexpected(parts.error());
    const std::size_t before = all.size();
    for (const HistoryPart& part : *parts) {
      for (const Operation& operation : part.operations) {
        // Revisions ascend: what does not is a part of a later answer, whose operations a part before had already.
        if (operation.revision > request.after_revision) all.push_back(operation);
        request.after_revision = std::max(request.after_revision, operation.revision);
      }
    }
    if (static_cast<std::int64_t>(all.size() - before) < page) return all;
  }
}

nlohmann::json to_json(const std::vector<Operation>& operations, double resolution) {
  nlohmann::json array = nlohmann::json::array();
  for (const Operation& o : operations) {
    array.push_back({{"revision", o.revision},
                     {"id", o.id},
                     {"author", o.author},
                     {"utime", o.utime},
                     {"time", format_utc_time(o.utime)},
                     {"kind", word_for(o.kind)},
                     {"subject", o.subject.empty() ? nlohmann::json() : nlohmann::json(o.subject)},
                     {"voxels", o.count},
                     {"undone", !o.active},
                     {"bounds", is_edit(o.kind) ? to_json(extent(o, resolution)) : nlohmann::json()}});
  }
  return {{"operations", array}};
}

std::string to_words(const std::vector<Operation>& operations, double resolution) {
  std::vector<std::vector<std::string>> rows = {
      {"revision", "time", "who", "what", "of", "voxels", kExtentHeading, "", "id"}};
  for (const Operation& o : operations) {
    rows.push_back({std::to_string(o.revision), format_local_time(o.utime), o.author, word_for(o.kind), o.subject,
                    is_edit(o.kind) ? format_count(o.count) : "",
                    is_edit(o.kind) ? to_words(extent(o, resolution)) : "", o.active ? "" : "undone", o.id});
  }
  return format_table(rows, "rllllrlll");
}

std::string to_csv(const std::vector<Operation>& operations, double resolution) {
  std::string csv = "revision,time,author,kind,subject,id,voxels,undone,min_x,min_y,min_z,max_x,max_y,max_z\r\n";
  for (const Operation& o : operations) {
    csv += std::to_string(o.revision) + "," + format_utc_time(o.utime) + "," + quoted(o.author) + "," +
           word_for(o.kind) + "," + quoted(o.subject) + "," + quoted(o.id) + "," + std::to_string(o.count) + "," +
           (o.active ? "false" : "true");
    const Box box = extent(o, resolution);
    for (const Eigen::Vector3d* corner : {&box.min, &box.max}) {
      for (int i = 0; i < 3; ++i) csv += "," + (is_edit(o.kind) ? format_number((*corner)[i], 4) : "");
    }
    csv += "\r\n";
  }
  return csv;
}

}  // namespace concord

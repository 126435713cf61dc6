#include "semantic/labels/label_loading.hpp"

#include <algorithm>

namespace concord {
namespace {

using Claim = LabelCorrection::Claim;

/// Their numbers as ours.
class Numbers {
 public:
  Numbers(const Labels& theirs, const Labels& ours) : theirs_(theirs) {
    for (const auto& [id, of_class] : ours.classes()) {
      by_name_[of_class.name] = id;
      given_[id] = of_class.highest();
    }
  }

  void are(InstanceId theirs, InstanceId ours) { instances_[theirs] = ours; }

  /// The claim's instance here; names the class in it where it is new.
  InstanceId of(InstanceId theirs, Claim& claim) {
    const std::string& name = theirs_.classes().at(theirs.label).name;
    const auto [it, is_new] = by_name_.try_emplace(name, given_.empty() ? 1 : given_.rbegin()->first + 1);
    claim.class_name = is_new ? name : "";
    const ClassId label = it->second;
    const auto known = instances_.find(theirs);
    if (known != instances_.end()) return known->second;
    std::uint32_t& given = given_[label];
    const std::uint32_t number = theirs.instance > given ? theirs.instance : given + 1;
    given = std::max(given, number);
    return instances_[theirs] = {label, number};
  }

 private:
  const Labels& theirs_;
  std::map<std::string, ClassId> by_name_;
  std::map<ClassId, std::uint32_t> given_;
  std::map<InstanceId, InstanceId> instances_;
};

Result<void> check_ids(const std::vector<LabelCorrection>& theirs, const Labels& ours) {
  for (const LabelCorrection& correction : theirs) {
    const Labels::Made* made = ours.find(correction.id);
    if (made != nullptr && made->content != correction.content) {
      return refuse(Code::kExists, "another label here has the id " + correction.id + " of one in the file");
    }
  }
  return {};
}

/// What holds of theirs and is not here, numbered as ours.
std::vector<LabelCorrection> holding(const std::vector<LabelCorrection>& theirs, const Labels& ours) {
  Labels all(1.0);
  BrickSet touched;
  for (const LabelCorrection& correction : theirs) all.apply(correction, touched);
  Numbers numbers(all, ours);
  for (const LabelCorrection& correction : theirs) {
    const auto there = all.owner_of(correction.id), here = ours.owner_of(correction.id);
    if (there && here) numbers.are(*there, *here);
  }
  std::vector<LabelCorrection> out;
  for (const LabelCorrection& correction : theirs) {
    const auto owner = all.owner_of(correction.id);
    if (!owner || ours.find(correction.id) != nullptr) continue;
    LabelCorrection next = correction;
    auto& claim = std::get<Claim>(next.what);
    claim.of = numbers.of(*owner, claim);
    next.revision = ours.revision() + static_cast<std::int64_t>(out.size()) + 1;
    out.push_back(std::move(next));
  }
  return out;
}

}  // namespace

Result<std::vector<LabelCorrection>> labels_to_load(const std::vector<LabelCorrection>& theirs, const Labels& ours) {
  if (ours.revision() == 0) return theirs;
  if (const auto fine = check_ids(theirs, ours); !fine) return tl::unexpected(fine.error());
  auto out = holding(theirs, ours);
  Labels after = ours;
  BrickSet touched;
  for (const LabelCorrection& one : out) {
    if (const auto fits = after.follows(one); !fits) return tl::unexpected(fits.error());
    after.apply(one, touched);
  }
  return out;
}

}  // namespace concord

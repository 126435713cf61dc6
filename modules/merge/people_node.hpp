#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "bus/list_stream.hpp"
#include "bus/process.hpp"
#include "bus/recent_answers.hpp"
#include "bus/replies.hpp"
#include "merge/agents_node.hpp"
#include "merge/map_streams.hpp"
#include "merge/merge_store.hpp"
#include "merge/people.hpp"

namespace concord {

/// What people ask for: each request is checked, stored, applied, shown and answered, in this order, so that nobody
/// sees what a power cut could take back. What cannot be stored is refused, and nothing has changed.
class PeopleNode {
 public:
  /// `people` is what the store holds. All of them must outlive this.
  PeopleNode(const NodeContext& context, MergeStore& store, People& people, MapStreams& map, AgentsNode& agents);
  PeopleNode(const PeopleNode&) = delete;
  PeopleNode& operator=(const PeopleNode&) = delete;

  /// Answers a request whose id was used before: as then if it asks the same, else with a refusal. Returns false if
  /// the id is new.
  [[nodiscard]] bool repeat(const std::string& channel, const std::string& id, std::uint64_t content);

  /// Stores, applies and shows corrections: all or none. @pre they follow on what was made. Refused: kIo.
  [[nodiscard]] Result<void> commit(std::span<const Correction> corrections);

 private:
  /// Hears requests of one type; `check` says what one leads to, and may look at all there is.
  template <class Request, class Check>
  void hear(const std::string& channel, Check check);
  void on_lease(const LeaseRequest& request);
  [[nodiscard]] Result<bool> hold(const LeaseRequest& request);

  [[nodiscard]] Result<Correction::Edit> check(const EditRequest& request);
  [[nodiscard]] Result<Correction::ZoneChange> check(const ZoneRequest& request);
  void follow(std::span<const Correction> corrections);
  void say_zones();
  void say_leases();
  void say_edits();
  [[nodiscard]] std::int64_t count_of(const Operation& made) const;
  void expire_leases();

  NodeContext context_;
  MergeStore& store_;
  People& people_;
  MapStreams& map_;
  AgentsNode& agents_;
  Replies replies_;
  RecentAnswers answers_;  ///< what the store does not keep: refusals, and all about leases
  ListSender<Zone> zone_list_;
  ListSender<Lease> lease_list_;
};

}  // namespace concord

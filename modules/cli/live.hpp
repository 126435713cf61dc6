#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "bus/brick_stream.hpp"
#include "bus/lcm_bus.hpp"
#include "bus/messages.hpp"
#include "bus/site.hpp"
#include "cli/command.hpp"

namespace concord {

/// Until then a request is sent again and again: datagrams get lost, and the stack does what it is asked once per id.
inline constexpr std::int64_t kAskAgain = 300'000;

/// A request as it goes out; or what the stack would refuse it for unread, by the same limits.
template <class Request>
[[nodiscard]] tl::expected<Bytes, Failure> to_send(const Request& request, std::int64_t now) {
  Bytes bytes = [&] {
    if constexpr (requires { encode(request); }) {
      return encode(request);
    } else {
      return encode(request, now);
    }
  }();
  if (const auto read = decode<Request>(bytes); !read) return fail(read.error().error);
  return bytes;
}

/// The running stack, as a client sees it.
class Live {
 public:
  /// @throws ConfigError for a site file that cannot be used, or when LCM cannot join.
  explicit Live(const Common& common);

  [[nodiscard]] LcmBus& bus() { return bus_; }
  [[nodiscard]] Counters& counters() { return counters_; }
  [[nodiscard]] const Site& site() const { return site_; }
  [[nodiscard]] double timeout() const { return timeout_; }

  /// Makes `site().resolution` the stack's, which may run on another site file: only then are its voxels the metres
  /// they are taken for. Merge says it each second. Fails with kNoAnswer.
  [[nodiscard]] tl::expected<void, Failure> take_resolution();

  /// An id that nobody else uses.
  [[nodiscard]] std::string new_id();
  /// `given`, whose answers are kept from now on; a new one if it is empty. @pre empty or is_request_id.
  [[nodiscard]] std::string id_or_new(const std::string& given);

  /// Calls `take(channel, value)` with each good message; what is malformed is passed over.
  template <class T, class Take>
  void hear(const std::string& channel_regex, Take take) {
    bus_.subscribe(channel_regex, [take](const std::string& channel, std::span<const std::uint8_t> bytes) {
      if (auto value = decode<T>(bytes)) take(channel, std::move(*value));
    });
  }

  /// Handles messages until `done()`, at most `seconds` or until the program is to end. @return done().
  bool wait(double seconds, const std::function<bool()>& done);
  /// The same, as long as `moves()` has not stayed what it is for `seconds`.
  bool wait_while_moving(double seconds, const std::function<std::int64_t()>& moves, const std::function<bool()>& done);
  /// The same, publishing `request` on `channel` at once and until then every kAskAgain.
  bool ask_until(const std::string& channel, const Bytes& request, double seconds, const std::function<bool()>& done);

  /// Asks and waits for the next answer to `id`; who is busy is asked again. Fails with what the stack refused it for,
  /// or kNoAnswer.
  template <class Request>
  [[nodiscard]] tl::expected<Answer, Failure> ask(const std::string& channel, const Request& request) {
    return to_send(request, bus_.now()).and_then([&](const Bytes& bytes) {
      return ask_bytes(channel, bytes, request.id);
    });
  }
  /// The answer to one of our ids, once it has come; of this process, where several answer.
  [[nodiscard]] const Answer* answer_to(const std::string& id) const;
  [[nodiscard]] const Answer* answer_to(const std::string& id, const std::string& process) const;
  /// The latest path for one of our ids; an active one is planned anew when the map changes.
  [[nodiscard]] const Path* path_for(const std::string& id) const;
  /// Nobody answered; what the caller can do about it.
  [[nodiscard]] tl::unexpected<Failure> no_answer(const std::string& who) const;

 private:
  [[nodiscard]] tl::expected<Answer, Failure> ask_bytes(const std::string& channel, const Bytes& request,
                                                        const std::string& id);

  Site site_;
  double timeout_;
  Counters counters_;
  LcmBus bus_;
  std::string id_prefix_;
  std::int64_t next_id_ = 0;
  [[nodiscard]] bool is_ours(const std::string& id) const { return id.starts_with(id_prefix_) || given_.contains(id); }

  std::optional<double> resolution_;  ///< of the map, as heard
  std::set<std::string> given_;
  std::map<std::string, std::map<std::string, Answer>> answers_;  ///< by id and process, the latest of each
  std::map<std::string, Path> paths_;
};

/// A copy of one brick stream of the running stack. Must live as long as `live` handles messages.
class StreamCopy {
 public:
  StreamCopy(Live& live, const std::string& stream);

  [[nodiscard]] bool synced() const { return copied_->receiver.heard() && copied_->receiver.synced(); }
  [[nodiscard]] bool heard() const { return copied_->receiver.heard(); }
  [[nodiscard]] std::int64_t missing() const { return copied_->receiver.missing(); }
  [[nodiscard]] std::int64_t revision() const { return copied_->receiver.revision(); }
  [[nodiscard]] const BrickMap& map() const { return copied_->map; }
  /// In sync with a sender that has ended.
  [[nodiscard]] bool ended() const { return synced() && copied_->receiver.frame_id().empty(); }

  /// Waits while `worth_it()`. Fails with kNoAnswer when nobody speaks, with kIncomplete when it did not arrive whole
  /// in time.
  [[nodiscard]] tl::expected<void, Failure> wait_synced(
      Live& live, const std::function<bool()>& worth_it = [] { return true; });

 private:
  /// What the bus goes on filling: it outlives this copy where its `Live` does.
  struct Copied {
    Copied(Live& live, const std::string& stream);
    BrickMap map;
    BrickReceiver receiver;
  };
  std::string stream_;
  std::shared_ptr<Copied> copied_;
};

/// Waits for an agent's submap. Fails as StreamCopy::wait_synced does, and soon (kRefused) where there is none to wait
/// for: no such agent (NO_AGENT), or one that has sent no submap (NO_MAP).
[[nodiscard]] tl::expected<void, Failure> wait_for_submap(Live& live, StreamCopy& copy, const std::string& agent);

/// An answer that is no last word: not now, ask again.
[[nodiscard]] bool is_busy(const Answer& answer);
/// What the stack said no to, as the client says it.
[[nodiscard]] tl::unexpected<Failure> refused(const Answer& answer);

/// Asks the running planner and prints the path.
[[nodiscard]] Outcome ask_path(PathRequest request, const Common& common);
/// The planner's word on `request`, or the stack's refusal.
[[nodiscard]] tl::expected<Path, Failure> request_path(Live& live, const PathRequest& request);

}  // namespace concord

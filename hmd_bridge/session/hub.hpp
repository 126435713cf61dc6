#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include "protocol/frame.hpp"
#include "session/layers.hpp"
#include "session/session.hpp"

namespace concord::hmd {

/// One request on its way: whose, and under which id.
struct Ask {
  std::int64_t session = 0;
  std::int64_t id = 0;
};

/// Where a connection comes from.
struct Peer {
  std::string address;
  bool local = false;  ///< from this machine, and not lured here by a page from elsewhere
};

/// All clients: who is here, what each may do, what waits for each. Values in, values out: the connections' texts and
/// frames go in with the time, what is to be written is asked for when a connection can take it.
class Hub {
 public:
  struct Config {
    SessionLimits limits;
    Role local_role = Role::kEdit;
    std::size_t max_clients = 64;  ///< of them four, or a quarter of fewer, are kept for this machine
    std::size_t max_clients_per_address = 16;
    double resolution = 0.05;
  };
  static constexpr std::int64_t kHelloWithin = 5'000'000;      ///< microseconds
  static constexpr std::int64_t kParked = 120'000'000;         ///< a session outlives its connection by so long
  static constexpr std::size_t kMaxPending = 64;               ///< requests of one client that wait
  static constexpr int kMaxParked = 64, kMaxParkedOfOne = 32;  ///< in all, and of one address
  static constexpr std::size_t kLocalPlaces = 4;               ///< of max_clients, that nobody from elsewhere takes
  static constexpr std::size_t kMaxUngreeted = 64;             ///< connections that have not said hello, from elsewhere
  static constexpr std::size_t kMaxUngreetedPerNetwork = 8;    ///< of them from one address, or one IPv6 /64

  /// What becomes of what clients say; called from within text() and binary().
  struct Handlers {
    /// A request that this client may make. It is answered by answer() or refuse(), at once or later.
    std::function<void(const Ask&, const RequestBody&)> on_request;
    /// A mesh or voxels frame, its payload as it came.
    std::function<void(const Ask&, PackedFrame)> on_upload;
    std::function<void(Session&)> on_tracking;
    std::function<void(Session&, bool resumed)> on_begin;
    std::function<void(const Session&)> on_end;
    /// Why a client may not be this agent; nothing: it may.
    std::function<std::optional<std::string>(const std::string& agent, Role role)> not_for_clients;
    /// Every refused and every changing request, in one line.
    std::function<void(const std::string&)> audit;
  };

  Hub(Gate& gate, Config config, Handlers handlers);

  // ------------------------------------------------------------------------------------------ the side of connections
  using Connection = std::int64_t;
  /// Refused (kBusy): more clients than there may be.
  [[nodiscard]] Result<Connection> open(const Peer& peer, std::int64_t now);
  void text(Connection connection, std::string_view text, std::int64_t now);
  void binary(Connection connection, ByteSpan bytes, std::int64_t now);
  void closed(Connection connection, std::int64_t now);
  /// The next to write; null texts and frames never. Nothing: wait until it is among take_ready().
  using Outgoing = std::variant<SharedText, FramePointer>;
  [[nodiscard]] std::optional<Outgoing> next(Connection connection);
  struct Closing {
    std::uint16_t code = 1000;
    std::string reason;
  };
  /// Set once the connection is to be closed and all that was to be said before has been taken.
  [[nodiscard]] std::optional<Closing> closing(Connection connection) const;
  /// Connections for which next() or closing() may have something new since the last call.
  [[nodiscard]] std::vector<Connection> take_ready();
  void tick(std::int64_t now);
  /// Ends the sessions of tokens that were taken away, or given another role.
  void keep_only(const std::function<bool(const Identity&)>& holds);
  /// Says bye to all: the server ends.
  void end();

  // ------------------------------------------------------------------------------------------- the side of the stack
  template <class Answer>
  void answer(const Ask& ask, const Answer& answer) {
    answer_text_to(ask, std::make_shared<const std::string>(answer_text(ask.id, answer)), "OK");
  }
  void refuse(const Ask& ask, Code code, const std::string& message);
  /// A frame that a request asked for, before its answer; kept with it for a client that lost its connection.
  void send(const Ask& ask, FramePointer frame);
  /// Only the newest of a key is kept; who comes later is told it at once.
  void tell_all(const std::string& key, std::string text);
  /// Who comes later is told it no more; who is here, still.
  void forget(const std::string& key) { state_.erase(key); }
  void tell(Session& session, const std::string& key, std::string text);

  [[nodiscard]] Session* find(std::int64_t session);
  [[nodiscard]] std::map<std::int64_t, Session>& sessions() { return sessions_; }

  /// Layers and who looks at them.
  [[nodiscard]] Layers& layers() { return layers_; }
  /// A layer began anew: all is void.
  void restart_layer(std::uint32_t stream, const std::string& epoch);
  /// Takes in what changed in a layer since the last call.
  void publish_layer(std::uint32_t stream, std::int64_t map_revision, bool synced);
  struct Looked {
    std::size_t blocks, lacking;
  };
  /// @pre the layer is there.
  Looked look(Session& session, std::uint32_t stream, const ViewRegion& region);
  [[nodiscard]] bool look_away(Session& session, std::uint32_t stream);

  /// A line of the audit about who did not get as far as the hub.
  void note_refused(const std::string& address, const std::string& request, const std::string& outcome) const {
    handlers_.audit("refused from=" + address + " request=" + request + " outcome=" + outcome);
  }

  [[nodiscard]] std::size_t connected() const { return links_.size(); }

 private:
  struct Link {
    Peer peer;
    std::int64_t opened = 0;
    std::optional<std::int64_t> session;
    std::deque<SharedText> first;    ///< before everything else
    std::deque<FramePointer> asked;  ///< frames that requests asked for
    std::size_t asked_bytes = 0;
    SharedText last;  ///< the bye
    std::optional<Closing> closing;
    TokenBucket refusals;
  };

  /// Whether another client of this peer's kind may come in.
  [[nodiscard]] bool has_place(const Peer& peer) const;
  /// Clients that are in: who has not said hello yet takes no place of theirs.
  [[nodiscard]] std::size_t greeted() const;
  [[nodiscard]] bool too_many_wait(const Peer& peer) const;
  void greet(Connection connection, Link& link, const ClientRequest& request, std::int64_t now);
  [[nodiscard]] static tl::unexpected<Error> refuse_busy(const char* why);
  void begin(Connection connection, Link& link, Session& session, const HelloRequest& hello, std::int64_t id,
             bool resumed, std::int64_t now);
  [[nodiscard]] static std::optional<Session::Kept> kept_of(const Session& session, const ShownLayer& map,
                                                            std::int64_t revision);
  [[nodiscard]] Session* resumable(const HelloRequest& hello, const Identity& identity);
  void take_request(Connection connection, Session& session, const ClientRequest& request, std::int64_t now);
  /// Whether the request is new; one that was asked before is answered from what was said.
  [[nodiscard]] bool is_new(Connection connection, Link& link, Session& session, std::int64_t id,
                            const std::string& name, std::int64_t now);
  void take_notice(Session& session, const NoticeBody& notice);
  void refuse_now(Connection connection, Link& link, Session& session, std::int64_t id, const std::string& name,
                  Code code, const std::string& message, std::int64_t now);
  void enqueue(Connection connection, Link& link, FramePointer frame);
  void answer_text_to(const Ask& ask, SharedText text, const char* outcome);
  void count_refusal(Connection connection, Link& link, std::int64_t now);
  void close(Connection connection, Link& link, std::uint16_t code, Code why, const std::string& message);
  void park(Session& session, std::int64_t now);
  [[nodiscard]] std::optional<Outgoing> next_block(Session& session);
  [[nodiscard]] SharedText complete_event(Session& session);
  void ready(const Session& session);
  void tell_behind(std::int64_t now);
  void sweep();
  void audit(const Session& session, const std::string& request, std::int64_t id, const std::string& outcome) const;

  Gate& gate_;
  Config config_;
  Handlers handlers_;
  Layers layers_;
  std::map<Connection, Link> links_;
  std::map<std::int64_t, Session> sessions_;
  std::map<std::string, SharedText> state_;  ///< what everyone is told, by key
  std::set<Connection> ready_;
  Connection last_connection_ = 0;
  std::int64_t last_session_ = 0;
  std::int64_t last_sweep_ = 0, last_behind_ = 0, now_ = 0;
};

}  // namespace concord::hmd

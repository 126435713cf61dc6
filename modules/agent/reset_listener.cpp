#include "agent/reset_listener.hpp"

#include "bus/messages.hpp"

namespace concord {

ResetListener::ResetListener(Bus& bus, Counters& counters, const std::string& agent, std::function<void()> on_reset)
    : state_(std::make_shared<State>(State{std::move(on_reset), {}})) {
  listen<FrameOver>(bus, counters, agent, "out/frame_over/" + agent,
                    [weak = std::weak_ptr(state_)](const std::string&, const FrameOver& over) {
                      const std::shared_ptr<State> state = weak.lock();
                      if (!state || state->frame_id != over.frame_id) return;
                      state->frame_id.clear();
                      state->on_reset();
                    });
}

}  // namespace concord

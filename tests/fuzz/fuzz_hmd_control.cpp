#include "must.hpp"
#include "protocol/control.hpp"

// Whatever a client sends as text is refused with a reason, or reads again as what it was.

using namespace concord;
using namespace concord::hmd;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto read = read_client_text({reinterpret_cast<const char*>(data), size});
  if (!read) {
    fuzz::must(!read.error().message.empty());
    static_cast<void>(Json(read.error().message).dump());  // throws if a character was cut in two
    return 0;
  }
  if (const auto* request = std::get_if<ClientRequest>(&*read)) {
    const Json body = std::visit([](const auto& b) { return write_value(b); }, request->body);
    const Json whole = {{"id", request->id}, {"request", info_of(request->body).name}, {"body", body}};
    const auto again = read_client_text(whole.dump());
    fuzz::must(again.has_value() && std::get<ClientRequest>(*again).body == request->body);
  }
  return 0;
}

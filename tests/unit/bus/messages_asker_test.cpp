#include <gtest/gtest.h>

#include "message_checks.hpp"

// A request that cannot be used is refused to whoever asked it, wherever their id can be read.

namespace concord::test {
namespace {

const Box kBox{{0, 0, 0}, {1, 1, 1}};

EditRequest an_edit() {
  EditRequest edit;
  edit.id = "e";
  edit.shape = kBox;
  return edit;
}

TEST(MessagesAsker, ATextOverItsLimitIsRefusedToItsAsker) {
  const std::string long_text(1000, 'x');
  const auto refused = [](const auto& request) {
    using Request = std::decay_t<decltype(request)>;
    const auto read = [&] {
      if constexpr (requires { encode(request); })
        return decode<Request>(encode(request));
      else
        return decode<Request>(encode(request, 1));
    }();
    expect_refused(read, Code::kTooLarge, "r");
    EXPECT_NE(read.error().error.message.find("1000 bytes"), std::string::npos) << read.error().error.message;
  };
  EditRequest edit = an_edit();
  edit.id = "r";
  edit.author = long_text;
  refused(edit);
  edit.author.clear();
  edit.frame.agent = long_text;
  refused(edit);
  refused(UndoRequest{"r", "me", long_text, false, 1});
  refused(ZoneRequest{"r", "me", ZoneRequest::Op::kAdd, long_text, Zone::Kind::kNoGo, kBox, {}, kAnyRevision, 1});
  refused(LeaseRequest{"r", long_text, "lease", true, kBox, {}, 1});
  refused(WeightRequest{"r", "me", long_text, 1, 1});
  refused(LocaliseRequest{"r", "me", long_text, Transform::Identity(), {}, 1});
  refused(TransformRequest{"r", "me", "robot1", long_text, Transform::Identity()});
  refused(HistoryRequest{"r", long_text, "", {}, 0, 0, 0, 1});
  refused(AgentRequest{"r", long_text, AgentRequest::Op::kReset});
  refused(DownsampleRequest{"r", long_text, 1});
  refused(MapRequest{"r", MapRequest::Op::kSave, long_text, {"bt"}, false, ""});
  PathRequest path;
  path.id = "r";
  path.robot = long_text;
  refused(path);
}

TEST(MessagesAsker, WhatIsCutOffIsRefusedToItsAskerOnceTheIdIsThere) {
  const Bytes whole = encode(an_edit());
  const std::size_t with_id = 8 + 8 + 4 + 2;  // fingerprint, time, and the text "e"
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const auto read = decode<EditRequest>(std::span(whole).first(size));
    expect_refused(read, Code::kMalformed, size < with_id ? "" : "e");
  }
  Bytes another_type = whole;
  another_type[0] ^= 1;
  expect_refused(decode<EditRequest>(another_type), Code::kMalformed, "");
  UndoRequest nobody{std::string(81, 'x'), "me", "e", false, 1};
  expect_refused(decode<UndoRequest>(encode(nobody)), Code::kTooLarge, "");
}

TEST(MessagesAsker, WhatWasOnceCalledAnythingCanBeTakenBack) {
  const std::string odd = " \u202Eold";
  EXPECT_TRUE(decode<UndoRequest>(encode(UndoRequest{"u", "me", odd, false, 1})));
  ZoneRequest zone{"z", "me", ZoneRequest::Op::kDelete, odd, Zone::Kind::kNoGo, kBox, {}, kAnyRevision, 1};
  EXPECT_TRUE(decode<ZoneRequest>(encode(zone)));
  zone.op = ZoneRequest::Op::kAdd;
  expect_refused(decode<ZoneRequest>(encode(zone)), Code::kBadName, "z");
}

}  // namespace
}  // namespace concord::test

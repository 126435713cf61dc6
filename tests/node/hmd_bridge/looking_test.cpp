// What is looked at: views, the grid, history; saved maps.

#include <fstream>

#include "bridge_test.hpp"
#include "core/octomap_reader.hpp"
#include "store/whole_file.hpp"

namespace concord::hmd {
namespace {

TEST_F(Working, AViewComesWholeThenJustWhatChanges) {
  EXPECT_CODE(ana.ask(ViewRequest{Layer::kMap, {}, Frame::kMap, {0, 0, 0}, {100}, {}}), "OK");
  lab.run(0.2);
  ana.read();
  int voxels = 0;
  for (const BinaryFrame& frame : ana.frames) {
    const BlockContent content = read_block(frame).value();
    for (const ChunkBits& bits : content.chunks) {
      for (const std::uint8_t byte : bits) voxels += std::popcount(byte);
    }
  }
  EXPECT_EQ(voxels, 64 * 64);
  EXPECT_EQ(ana.events["complete"]["stream"], 0);
  ana.frames.clear();
  EXPECT_CODE(ana.ask(add(Voxels{0.1, {{{20, 20, 3, 20, 20, 3}}}})), "OK");
  lab.run(0.5);
  ana.read();
  ASSERT_EQ(ana.frames.size(), 1u);
  EXPECT_EQ(read_block(ana.frames[0])->chunks.size(), 1u);
  EXPECT_LT(ana.frames[0].payload.size(), 600u);
  EXPECT_CODE(ana.ask(ViewRequest{Layer::kAgent, "robot1", Frame::kMap, {0, 0, 0}, {0, 0, 100}, {}}), "OK");
  EXPECT_CODE(ana.ask(ViewRequest{Layer::kAgent, "nobody", Frame::kMap, {0, 0, 0}, {100}, {}}), "NO_AGENT");
  EXPECT_CODE(ana.ask(ViewRequest{Layer::kMap, {}, Frame::kMap, {0, 0, 0}, {5, 2}, {}}), "BAD_REQUEST");
  EXPECT_CODE(ana.ask(ViewRequest{Layer::kMap, {}, Frame::kOwn, {0, 0, 0}, {5}, {}}), "BAD_FRAME");
  EXPECT_CODE(ana.ask(ViewCloseRequest{0}), "OK");
  EXPECT_CODE(ana.ask(ViewCloseRequest{0}), "NOT_FOUND");
}

TEST_F(Working, CompleteIsSaidWhenTheBlocksHaveComeAndNotBefore) {
  EXPECT_CODE(ana.ask(ViewRequest{Layer::kMap, {}, Frame::kMap, {0, 0, 0}, {100}, {}}), "OK");
  lab.run(0.2);
  ana.read();
  const std::int64_t before = ana.events["complete"]["revision"];
  ana.frames.clear();
  const std::string edit = request_text(ana.next_id(), add(Voxels{0.1, {{{20, 20, 3, 20, 20, 3}}}}));
  lab.bridge->hub().text(ana.connection, edit, lab.bus->now());
  const bool said = lab.run_until(2, [&] {
    ana.read();
    return ana.events["complete"]["revision"] > before;
  });
  ASSERT_TRUE(said);
  EXPECT_EQ(ana.frames.size(), 1u);
}

TEST_F(Working, WithoutCreditNoBlockComes) {
  Client bert(lab);
  HelloRequest hello;
  hello.version = kProtocol;
  EXPECT_CODE(bert.ask(hello), "OK");
  EXPECT_CODE(bert.ask(ViewRequest{Layer::kMap, {}, Frame::kMap, {0, 0, 0}, {100}, {}}), "OK");
  lab.run(1);
  bert.read();
  EXPECT_TRUE(bert.frames.empty());
  bert.note(CreditNotice{400});
  EXPECT_LE(bert.bytes, 400);
  bert.note(CreditNotice{1'000'000});
  EXPECT_FALSE(bert.frames.empty());
}

TEST_F(Working, TheGridBetweenTwoHeightsComesAsCells) {
  const Json answer = ana.ask(GridRequest{{0.1, 0.8}});
  EXPECT_CODE(answer, "OK");
  EXPECT_EQ(answer["answer"]["free"], 64 * 64);
  EXPECT_EQ(answer["answer"]["occupied"], 0);
  ASSERT_EQ(ana.frames.size(), 1u);
  EXPECT_EQ(ana.frames[0].head.kind, FrameKind::kCells);
  EXPECT_EQ(ana.ask(GridRequest{{-0.1, 0.1}})["answer"]["occupied"], 64 * 64);
  EXPECT_CODE(ana.ask(GridRequest{{5, 6}}), "NO_MAP");
  EXPECT_CODE(ana.ask(GridRequest{{1, 1}}), "OUT_OF_BOUNDS");
}

TEST_F(Working, HistoryTellsWhoDidWhat) {
  EXPECT_CODE(ana.ask(add(box(1, 1, 0.2, 1.5, 1.5, 0.5))), "OK");
  const Json answer = ana.ask(HistoryRequest{{}, {}, {}, {}, 100});
  EXPECT_CODE(answer, "OK");
  ASSERT_EQ(answer["answer"]["operations"].size(), 2u) << "a placement and an edit";
  EXPECT_EQ(answer["answer"]["operations"][1]["author"], "ana");
}

TEST_F(Working, MapsAreSavedListedAndLoaded) {
  const SaveRequest save{"hall", {Format::kBt, Format::kConcord}, false};
  lab.run(3);
  const Json saved = ana.ask(save);
  EXPECT_CODE(saved, "OK");
  ASSERT_EQ(saved["answer"]["files"].size(), 2u);
  const std::filesystem::path maps = lab.site.state / "maps";
  for (const Json& file : saved["answer"]["files"]) {
    EXPECT_EQ(file["bytes"], std::filesystem::file_size(maps / file["file"].get<std::string>()));
  }
  EXPECT_CODE(ana.ask(SaveRequest{"hall", {Format::kOt, Format::kBt}, false}), "EXISTS");
  EXPECT_FALSE(std::filesystem::exists(maps / "hall.ot")) << "an error means that nothing has changed";
  const Json full = ana.ask(SaveRequest{"full", {Format::kOt}, false});
  const auto written = read_whole_file(maps / "full.ot", 10'000'000);
  ASSERT_TRUE(written);
  const std::uint64_t content = std::stoull(full["answer"]["content"].get<std::string>(), nullptr, 16);
  EXPECT_EQ(content, digest(read_octomap_file(*written, std::nullopt)->map)) << "of what was written";
  EXPECT_CODE(ana.ask(save), "EXISTS");
  EXPECT_EQ(ana.ask(MapsRequest{})["answer"]["maps"].size(), 3u);
  const std::int64_t id = ana.next_id();
  const Json climb = {
      {"id", id}, {"request", "save"}, {"body", {{"map", "../x"}, {"formats", {"bt"}}, {"overwrite", false}}}};
  EXPECT_CODE(ana.ask_text(id, climb.dump()), "BAD_NAME") << "no name is a path";
  std::filesystem::create_directories(lab.site.state / "maps" / "busy.bt" / "in the way");
  EXPECT_CODE(ana.ask(SaveRequest{"busy", {Format::kBt}, true}), "IO");
  EXPECT_CODE(ana.ask(LoadRequest{"hall", Format::kBt, "copy"}), "OK");
  EXPECT_CODE(ana.ask(LoadRequest{"hall", Format::kBt, "copy"}), "EXISTS");
  EXPECT_CODE(ana.ask(LoadRequest{"none", {}, {}}), "NOT_FOUND");
  std::ofstream(lab.site.state / "maps" / "broken.bt") << "no map";
  EXPECT_CODE(ana.ask(LoadRequest{"broken", {}, {}}), "CORRUPT");
}

/// Says what ingest would say of a submap with so many points.
void answer_with_points(Lab& lab, std::size_t many) {
  lab.bus->subscribe(
      "in/downsample",
      [&lab, many](const std::string&, std::span<const std::uint8_t> bytes) {
        const DownsampleRequest asked = decode<DownsampleRequest>(bytes).value();
        constexpr std::size_t kInPart = 10'000;
        Downsampled part{asked.id, asked.agent, "odom", asked.resolution, 0, 0, {}};
        part.parts = static_cast<std::int32_t>((many + kInPart - 1) / kInPart);
        for (std::size_t first = 0; first < many; first += kInPart, ++part.part) {
          part.points.clear();
          for (std::size_t i = first; i < std::min(many, first + kInPart); ++i)
            part.points.push_back(Eigen::Vector3f::Constant(std::sin(static_cast<float>(i))));
          lab.bus->publish("out/downsampled", encode(part, lab.bus->now()));
        }
        answer(*lab.bus, {asked.id, "ingest", true, "OK", "", 0, static_cast<std::int64_t>(many)});
      },
      100);
}

TEST(Minimaps, OneOfManyMegabytesComesWhole) {
  Lab lab(Lab::kWithoutIngest);
  constexpr std::size_t kMany = (16 << 20) / 12;
  answer_with_points(lab, kMany);
  Client ana(lab);
  EXPECT_CODE(ana.hello(), "OK");
  EXPECT_CODE(ana.ask(MinimapRequest{"robot1", 0.1}), "OK");
  ASSERT_EQ(ana.frames.size(), 1u);
  EXPECT_EQ(ana.frames[0].payload.size(), kMany * 12);
  EXPECT_GT(ana.bytes, 4 << 20) << "on the wire";
}

TEST(Minimaps, OneThatNoReaderTakesIsRefusedInWordsThatHelp) {
  Lab lab(Lab::kWithoutIngest);
  answer_with_points(lab, (16 << 20) / 12 + 1);
  Client ana(lab);
  EXPECT_CODE(ana.hello(), "OK");
  const Json refused = ana.ask(MinimapRequest{"robot1", 0.1});
  EXPECT_CODE(refused, "TOO_LARGE");
  EXPECT_NE(refused["error"]["message"].get<std::string>().find("0.12 m"), std::string::npos) << refused;
  EXPECT_TRUE(ana.frames.empty());
  EXPECT_CODE(ana.ask(MapsRequest{}), "OK") << "and goes on";
}

TEST_F(Working, AnyAgentCanBeLookedAtOneAfterTheOther) {
  for (int i = 0; i < 40; ++i) {
    const std::string agent = "cart" + std::to_string(i);
    lab.bus->publish("in/" + agent + "/pose", encode(AgentPose{agent, "odom", Transform::Identity(), lab.bus->now()}));
  }
  lab.run(1.5);
  for (int i = 0; i < 40; ++i) {
    const Json view = ana.ask(ViewRequest{Layer::kAgent, "cart" + std::to_string(i), Frame::kMap, {0, 0, 0}, {5}, {}});
    ASSERT_TRUE(has_code(view, "OK")) << i;
    EXPECT_CODE(ana.ask(ViewCloseRequest{view["answer"]["stream"]}), "OK");
    lab.run(0.2);
  }
}

}  // namespace
}  // namespace concord::hmd

#include "core/map_archive.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <functional>

#include "archives.hpp"
#include "core/brick_codec.hpp"
#include "core/map_archive_parts.hpp"

namespace concord {
namespace {

using archive::Tag;
using test::arbitrary_archive;
using test::correction;
using test::edit_of;
using test::same;
using test::small_archive;
using test::write;

/// How a file is refused; "OK" when it is not.
std::string refusal(const Bytes& file, const MapArchiveOptions& options = {}) {
  const auto read = read_map_archive(file, options);
  return read ? "OK" : name(read.error().code);
}

std::string why(const Bytes& file) {
  const auto read = read_map_archive(file);
  return read ? "" : read.error().message;
}

/// A file put together by hand; its frame is right, whatever stands in it.
class FileOf {
 public:
  FileOf() { archive::append_file_head(bytes_); }

  FileOf& section(Tag tag, const std::function<void(Bytes&)>& fill, std::uint32_t version = archive::kVersion) {
    const std::size_t begin = archive::begin_section(bytes_, tag, version);
    fill(bytes_);
    archive::end_section(bytes_, begin);
    ++sections_;
    return *this;
  }
  FileOf& lattice(double resolution = 0.1) {
    return section(archive::kLattice, [&](Bytes& out) { archive::append_real(out, resolution); });
  }
  FileOf& layer(const LayerHead& head, std::uint64_t bricks, std::uint64_t known, const Bytes& tiles) {
    return section(archive::kLayer, [&](Bytes& out) {
      archive::append_layer(out, head, BrickMap());
      out.resize(out.size() - 16);
      append_le(out, bricks);
      append_le(out, known);
      out.insert(out.end(), tiles.begin(), tiles.end());
    });
  }
  FileOf& corrections(const std::vector<Correction>& all = {}) {
    return section(archive::kCorrections, [&](Bytes& out) {
      for (const Correction& one : all) archive::append_correction(out, one);
    });
  }
  [[nodiscard]] Bytes end() {
    section(archive::kEnd, [this](Bytes& out) { append_le(out, sections_); });
    return bytes_;
  }

 private:
  Bytes bytes_;
  std::uint64_t sections_ = 0;
};

const LayerHead kRobot{"robot1", "robot", "f", 1, 1};

/// One tile with one brick of one voxel.
Bytes one_brick(std::uint64_t tile = 0, std::uint64_t present = 1) {
  Bytes out;
  append_varint(out, tile);
  append_le(out, present);
  append_brick(out, Brick::uniform({1}, kFree));
  return out;
}

Bytes file_with(const std::vector<Correction>& corrections) {
  return FileOf().lattice().corrections(corrections).end();
}

RC_GTEST_PROP(MapArchive, WhatIsWrittenIsReadAgain, ()) {
  const MapArchive archive = *arbitrary_archive();
  const Bytes file = write(archive);
  const auto read = read_map_archive(file);
  RC_ASSERT(read.has_value());
  RC_ASSERT(same(*read, archive));
  RC_ASSERT(write(*read) == file);
}

RC_GTEST_PROP(MapArchive, BytesDoNotHangOnHowTheLayersCameAbout, ()) {
  const MapArchive archive = *arbitrary_archive();
  MapArchive again = archive;
  for (SavedLayer& layer : again.layers) {
    BrickMap other;
    auto bricks = layer.bricks.sorted_bricks();
    std::reverse(bricks.begin(), bricks.end());
    other.set({1, 2, 3}, Brick::uniform({1}, kFree));
    if (layer.bricks.find(BrickIndex{1, 2, 3}) == nullptr) other.set({1, 2, 3}, Brick());
    for (const BrickIndex index : bricks) other.set(index, *layer.bricks.find(index));
    layer.bricks = std::move(other);
  }
  RC_ASSERT(write(again) == write(archive));
}

RC_GTEST_PROP(MapArchive, NoByteCanChangeUnseen, ()) {
  Bytes file = write(*arbitrary_archive());
  file[*rc::gen::inRange<std::size_t>(0, file.size())] ^= *rc::gen::nonZero<std::uint8_t>();
  RC_ASSERT(refusal(file) == "MALFORMED");
}

RC_GTEST_PROP(MapArchive, NoFileCanBeCutShortOrGoOn, ()) {
  Bytes file = write(*arbitrary_archive());
  Bytes longer = file;
  longer.push_back(*rc::gen::arbitrary<std::uint8_t>());
  RC_ASSERT(refusal(longer) == "MALFORMED");
  file.resize(*rc::gen::inRange<std::size_t>(0, file.size()));
  RC_ASSERT(refusal(file) == "MALFORMED");
}

TEST(MapArchive, EveryPrefixOfASmallFileIsRefused) {
  const Bytes file = write(small_archive());
  for (std::size_t size = 0; size < file.size(); ++size) {
    EXPECT_EQ(refusal(Bytes(file.begin(), file.begin() + static_cast<std::ptrdiff_t>(size))), "MALFORMED") << size;
  }
}

TEST(MapArchive, BytesAreAsDocumented) {
  const Bytes expected{0x89, 'C', 'O', 'N', 'C', 'O', 'R', 'D', '\r', '\n', 0x1A, '\n', 1, 0, 0,    0,     // head
                       'L',  'A', 'T', 'T', 1,   0,   0,   0,   8,    0,    0,    0,    0, 0, 0,    0,     //
                       0,    0,   0,   0,   0,   0,   0,   0,   0,    0,    0,    0,    0, 0, 0xE0, 0x3F,  // 0.5
                       'C',  'O', 'R', 'R', 1,   0,   0,   0,   0,    0,    0,    0,    0, 0, 0,    0,     //
                       0,    0,   0,   0,   0,   0,   0,   0,                                              //
                       'E',  'N', 'D', '.', 1,   0,   0,   0,   8,    0,    0,    0,    0, 0, 0,    0,     //
                       0,    0,   0,   0,   0,   0,   0,   0,   2,    0,    0,    0,    0, 0, 0,    0};
  Bytes file = write({0.5, {}, {}, {}});
  ASSERT_EQ(file.size(), expected.size());
  for (const std::size_t checksum : {32, 64, 88}) std::fill_n(file.begin() + static_cast<int>(checksum), 8, 0);
  EXPECT_EQ(file, expected);
}

/// A change of these is a change of the format: files that people saved could not be read any more.
TEST(MapArchive, BytesStayAsTheyAre) {
  const Bytes file = write(small_archive());
  EXPECT_EQ(file.size(), 885U);
  EXPECT_EQ(loaded_incarnation(file, "golden"), 8974280017016484674) << "XXH3 of file and request";
}

TEST(MapArchive, BricksNeedNotBeKept) {
  const auto read = read_map_archive(write(small_archive()), {.keep_bricks = false}).value();
  ASSERT_EQ(read.layers.size(), 2U);
  EXPECT_EQ(read.layers[1].head, small_archive().layers[1].head);
  EXPECT_TRUE(read.layers[1].bricks.empty());
  EXPECT_EQ(read.corrections.size(), small_archive().corrections.size());
  const Bytes bad = FileOf().lattice().layer(kRobot, 1, 2, one_brick()).corrections().end();
  EXPECT_EQ(refusal(bad, {.keep_bricks = false}), "MALFORMED") << "they are checked all the same";
}

TEST(MapArchive, UnknownSectionsArePassedOver) {
  const auto note = [](Bytes& out) { out.push_back(42); };
  const Bytes file = FileOf()
                         .section({'N', 'O', 'T', 'E'}, note)
                         .lattice()
                         .section({'P', 'I', 'C', 'T'}, note, 77)
                         .layer(kRobot, 1, 1, one_brick())
                         .corrections({correction(1, "e", edit_of({{1, 2, 3}}))})
                         .section({0, 0, 0, 0}, [](Bytes&) {})
                         .end();
  const auto read = read_map_archive(file);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->layers.at(0).bricks.known_count(), 1U);
  EXPECT_EQ(read->corrections.size(), 1U);
}

TEST(MapArchive, ANewerVersionIsRefusedInSoManyWords) {
  for (const Tag tag : {archive::kLattice, archive::kLayer, archive::kCorrections, archive::kEnd}) {
    const Bytes file = FileOf()
                           .section(
                               tag, [](Bytes&) {}, 2)
                           .end();
    EXPECT_NE(why(file).find("run a newer one"), std::string::npos) << why(file);
    EXPECT_NE(why(file).find(std::string(tag.begin(), tag.end()) + " has version 2"), std::string::npos) << why(file);
  }
  Bytes file = write(small_archive());
  file[12] = 2;
  EXPECT_NE(why(file).find("run a newer one"), std::string::npos) << why(file);
}

TEST(MapArchive, ForeignFilesAreRefused) {
  const std::string octomap = "# Octomap OcTree binary file\nid OcTree\nsize 0\nres 0.05\ndata\n";
  EXPECT_NE(why(Bytes(octomap.begin(), octomap.end())).find("no .concord file"), std::string::npos);
  EXPECT_NE(why({}).find("no .concord file"), std::string::npos);
}

TEST(MapArchive, SectionsStandInTheirOrder) {
  EXPECT_EQ(refusal(FileOf().lattice().corrections().end()), "OK");
  EXPECT_EQ(refusal(FileOf().corrections().end()), "MALFORMED") << "no lattice";
  EXPECT_EQ(refusal(FileOf().lattice().end()), "MALFORMED") << "no corrections";
  EXPECT_EQ(refusal(FileOf().lattice().lattice().corrections().end()), "MALFORMED");
  EXPECT_EQ(refusal(FileOf().lattice().corrections().corrections().end()), "MALFORMED");
  EXPECT_EQ(refusal(FileOf().lattice().corrections().layer(kRobot, 0, 0, {}).end()), "MALFORMED");
  EXPECT_EQ(refusal(FileOf().layer(kRobot, 0, 0, {}).lattice().corrections().end()), "MALFORMED");
  const LayerHead other{"robot0", "robot", "f", 1, 1};
  EXPECT_EQ(refusal(FileOf().lattice().layer(other, 0, 0, {}).layer(kRobot, 0, 0, {}).corrections().end()), "OK");
  EXPECT_EQ(refusal(FileOf().lattice().layer(kRobot, 0, 0, {}).layer(other, 0, 0, {}).corrections().end()),
            "MALFORMED");
  EXPECT_EQ(refusal(FileOf().lattice().layer(kRobot, 0, 0, {}).layer(kRobot, 0, 0, {}).corrections().end()),
            "MALFORMED");
}

TEST(MapArchive, ASectionThatIsMissingIsSeen) {
  const Bytes whole = FileOf().lattice().layer(kRobot, 0, 0, {}).corrections().end();
  const std::size_t layer = 16 + 24 + 8;
  const std::size_t size = 24 + 3 * 1 + 6 + 5 + 1 + 8 + 2 + 16;
  Bytes file = whole;
  file.erase(file.begin() + layer, file.begin() + layer + size);
  ASSERT_EQ(file[layer], 'C');
  EXPECT_EQ(refusal(file), "MALFORMED");
}

TEST(MapArchive, AnotherResolutionIsRefused) {
  const Bytes file = write(small_archive());
  EXPECT_EQ(refusal(file, {.resolution = 0.05}), "OK");
  EXPECT_EQ(refusal(file, {.resolution = 0.1}), "RES_MISMATCH");
  for (const double bad : {0.0, -0.1, 1e9, static_cast<double>(NAN), static_cast<double>(INFINITY)}) {
    EXPECT_EQ(refusal(FileOf().lattice(bad).corrections().end()), "MALFORMED") << bad;
  }
}

TEST(MapArchive, LayersMustBeOnes) {
  const auto with = [](const LayerHead& head, std::uint64_t bricks, std::uint64_t known, const Bytes& tiles) {
    return refusal(FileOf().lattice().layer(head, bricks, known, tiles).corrections().end());
  };
  EXPECT_EQ(with(kRobot, 1, 1, one_brick()), "OK");
  EXPECT_EQ(with({"../x", "robot", "f", 1, 1}, 1, 1, one_brick()), "MALFORMED");
  EXPECT_EQ(with({"robot1", "", "f", 1, 1}, 1, 1, one_brick()), "MALFORMED");
  EXPECT_EQ(with({"robot1", "robot", "a/b", 1, 1}, 1, 1, one_brick()), "MALFORMED");
  EXPECT_EQ(with({"robot1", "robot", "f", 1, 0}, 1, 1, one_brick()), "MALFORMED");
  EXPECT_EQ(with({"robot1", "robot", "f", 1, 1001}, 1, 1, one_brick()), "MALFORMED");
  EXPECT_EQ(with(kRobot, 2, 1, one_brick()), "MALFORMED") << "fewer bricks than it says";
  EXPECT_EQ(with(kRobot, 0, 1, one_brick()), "MALFORMED") << "more bricks than it says";
  EXPECT_EQ(with(kRobot, 1, 2, one_brick()), "MALFORMED") << "fewer voxels than it says";
  EXPECT_EQ(with(kRobot, 1, 0, one_brick()), "MALFORMED") << "more voxels than it says";
  EXPECT_EQ(with(kRobot, 1, 1, one_brick(0, 0)), "MALFORMED") << "a tile without bricks";
  EXPECT_EQ(with(kRobot, 2, 1, one_brick(0, 3)), "MALFORMED") << "a brick is missing";
  const std::uint64_t tiles = std::uint64_t{2048} * 2048 * 2048;
  EXPECT_EQ(with(kRobot, 1, 1, one_brick(tiles - 1)), "OK") << "the last tile of all";
  EXPECT_EQ(with(kRobot, 1, 1, one_brick(tiles)), "MALFORMED") << "beyond the lattice";
  EXPECT_EQ(with(kRobot, 1, 1, one_brick(~std::uint64_t{0})), "MALFORMED");
  Bytes empty_brick = one_brick();
  empty_brick.resize(9);
  empty_brick.push_back(0);
  EXPECT_EQ(with(kRobot, 1, 0, empty_brick), "MALFORMED");
  EXPECT_EQ(with(kRobot, 1, 1, Bytes(9, 0xFF)), "MALFORMED");
}

TEST(MapArchive, WhatIsTooLargeIsRefusedBeforeAnyIsRead) {
  const auto with = [](std::uint64_t bricks, std::uint64_t known) {
    return FileOf().lattice().layer(kRobot, bricks, known, one_brick()).corrections().end();
  };
  EXPECT_EQ(refusal(with(kMaxArchiveBricks + 1, 1)), "TOO_LARGE");
  EXPECT_EQ(refusal(with(~std::uint64_t{0}, 1)), "TOO_LARGE");
  EXPECT_EQ(refusal(with(1, 400'000'001)), "TOO_LARGE");
  EXPECT_EQ(refusal(with(1, kMaxArchiveVoxels + 1), {.known_voxels = ~std::uint64_t{0}}), "TOO_LARGE");
  EXPECT_EQ(refusal(with(1, 2), {.known_voxels = 1}), "TOO_LARGE");
  EXPECT_EQ(refusal(with(1, 1), {.known_voxels = 1}), "OK");
  FileOf many;
  many.lattice();
  for (std::size_t i = 0; i <= kMaxArchiveLayers; ++i) {
    many.layer({"a" + std::to_string(10'000 + i), "robot", "f", 1, 1}, 0, 0, {});
  }
  EXPECT_EQ(refusal(many.corrections().end()), "TOO_LARGE");
  EXPECT_EQ(refusal(Bytes(kMaxArchiveBytes + 1)), "TOO_LARGE");
}

TEST(MapArchive, EditsThatWouldFillTheMemoryAreRefused) {
  const auto with = [](VoxelIndex min, VoxelIndex max, std::uint32_t count) {
    return refusal(FileOf()
                       .lattice()
                       .section(archive::kCorrections,
                                [&](Bytes& out) {
                                  archive::append_correction(out, correction(1, "e", edit_of({})));
                                  out.resize(out.size() - 8);
                                  append_le(out, count);
                                  for (const auto v : {min, max}) {
                                    for (const auto c : {v.x, v.y, v.z}) append_le(out, static_cast<std::int16_t>(c));
                                  }
                                  append_le(out, std::uint32_t{0});
                                })
                       .end());
  };
  EXPECT_EQ(with({0, 0, 0}, {99, 99, 99}, 1), "OK") << "as many as an edit of the first release pinned";
  EXPECT_EQ(with({0, 0, 0}, {100, 99, 99}, 1), "TOO_LARGE");
  EXPECT_EQ(with({-32768, -32768, -32768}, {32767, 32767, 32767}, 1), "TOO_LARGE");
  EXPECT_EQ(with({0, 0, 0}, {1, 1, 1}, 0xFFFFFFFF), "MALFORMED") << "more boxes than bytes";
  EXPECT_EQ(with({1, 0, 0}, {0, 0, 0}, 1), "MALFORMED") << "inside out";
}

TEST(MapArchive, BoxesThatAreNotTheFewestAreRefused) {
  Bytes twice;
  archive::append_correction(twice, correction(1, "e", edit_of({{0, 0, 0}})));
  const Bytes box(twice.end() - 16, twice.end() - 4);
  twice.resize(twice.size() - 20);
  append_le(twice, std::uint32_t{2});
  for (int i = 0; i < 2; ++i) twice.insert(twice.end(), box.begin(), box.end());
  append_le(twice, std::uint32_t{0});
  const auto fill = [&](Bytes& out) { out.insert(out.end(), twice.begin(), twice.end()); };
  EXPECT_EQ(refusal(FileOf().lattice().section(archive::kCorrections, fill).end()), "MALFORMED");
}

TEST(MapArchive, CorrectionsThatCannotFollowAreRefusedWithTheirNumber) {
  const Correction edit = correction(3, "e", edit_of({{1, 2, 3}}));
  EXPECT_EQ(refusal(file_with({edit, correction(4, "u", Correction::Undo{"e", false})})), "OK");
  const Bytes bad = file_with({edit, correction(4, "u", Correction::Undo{"none", false})});
  EXPECT_EQ(refusal(bad), "MALFORMED");
  EXPECT_NE(why(bad).find("correction 4: no edit or placement before this is called none"), std::string::npos)
      << why(bad);
}

TEST(MapArchive, CorrectionsOfAnUnknownKindAreRefused) {
  Bytes one;
  archive::append_correction(one, correction(1, "w", Correction::Weight{"robot1", 2}));
  const std::size_t kind = 8 + 2 + 4 + 8 + 8;
  ASSERT_EQ(one[kind], 5);
  const auto with = [&](std::size_t at, std::uint8_t value) {
    Bytes changed = one;
    changed[at] = value;
    return refusal(
        FileOf()
            .lattice()
            .section(archive::kCorrections, [&](Bytes& out) { out.insert(out.end(), changed.begin(), changed.end()); })
            .end());
  };
  EXPECT_EQ(with(kind, 5), "OK");
  EXPECT_EQ(with(kind, 0), "MALFORMED");
  EXPECT_EQ(with(kind, 6), "MALFORMED");
  EXPECT_EQ(with(8, 200), "MALFORMED") << "an id longer than all that is left";
}

TEST(MapArchive, TheWriterRefusesWhatCouldNotBeRead) {
  MapArchiveWriter writer(0.1);
  const auto code = [](const Result<void>& result) { return result ? "OK" : name(result.error().code); };
  EXPECT_STREQ(code(writer.add({"no/name", "robot", "f", 1, 1}, {})), "BAD_NAME");
  EXPECT_STREQ(code(writer.add({"robot1", "robot", "f", 1, 0}, {})), "BAD_REQUEST");
  EXPECT_STREQ(code(writer.add(correction(1, "u", Correction::Undo{"e", false}))), "NOT_FOUND");
  EXPECT_STREQ(code(writer.add(correction(1, "e", edit_of({{1, 2, 3}})))), "OK");
  EXPECT_EQ(read_map_archive(std::move(writer).finish().value()).value().corrections.size(), 1U)
      << "what was refused is not in it";
}

TEST(MapArchive, LoadedAgentsHaveAnIncarnationOfTheirFileAndRequest) {
  const Bytes file = write(small_archive());
  const Bytes other = write({0.5, {}, {}, {}});
  const std::int64_t incarnation = loaded_incarnation(file, "q1");
  EXPECT_GE(incarnation, kLoadedIncarnation);
  EXPECT_EQ(loaded_incarnation(file, "q1"), incarnation);
  EXPECT_NE(loaded_incarnation(file, "q2"), incarnation);
  EXPECT_NE(loaded_incarnation(other, "q1"), incarnation);
}

}  // namespace
}  // namespace concord

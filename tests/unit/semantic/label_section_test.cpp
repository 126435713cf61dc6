#include "semantic/labels/label_section.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "core/map_archive.hpp"
#include "semantic/labels/label_loading.hpp"

namespace concord {
namespace {

using Claim = LabelCorrection::Claim;

LabelCorrection correction(std::int64_t revision, Labels::What what) {
  return {revision,       "l" + std::to_string(revision), "Zoë", 17, 99 + static_cast<std::uint64_t>(revision),
          std::move(what)};
}

std::vector<LabelCorrection> of_each_kind() {
  Transform T = Transform::Identity();
  T.linear() = Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitY()).toRotationMatrix();
  T.translation() = Eigen::Vector3d(0.1, 1.0 / 3, -2);
  return {correction(1, Claim{{1, 1}, "chair", {{-3, 0, 2}, {-2, 0, 2}}, "", {"robot1", "odom", T}}),
          correction(2, Claim{{2, 1}, "Tür", {{5, 5, 5}}, "asset-x", {}, {"pallet", T, ""}}),
          correction(4, Claim{{1, 2}, "", {{7, 7, 7}}, "", {}}),
          correction(5, LabelCorrection::Rename{1, "stool"}),
          correction(6, LabelCorrection::Reassign{{1, 2}, {2, 2}}),
          correction(7, LabelCorrection::TakeOff{{1, 0}}),
          correction(8, LabelCorrection::Undo{"l7", false})};
}

Bytes section_of(const std::vector<LabelCorrection>& all) {
  Bytes out;
  for (const LabelCorrection& one : all) append_label_correction(out, one);
  return out;
}

Labels folded(const std::vector<LabelCorrection>& all) {
  Labels labels(0.05);
  BrickSet touched;
  for (const LabelCorrection& one : all) {
    EXPECT_TRUE(labels.follows(one));
    labels.apply(one, touched);
  }
  return labels;
}

TEST(LabelSection, GivesBackEachKindToTheBit) {
  const Bytes bytes = section_of(of_each_kind());
  const auto read = read_label_section(bytes);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(section_of(*read), bytes);
  const auto& first = std::get<Claim>(read->front().what);
  EXPECT_EQ(first.anchor.T_map_agent.matrix(), std::get<Claim>(of_each_kind()[0].what).anchor.T_map_agent.matrix());
}

TEST(LabelSection, StandsInAMapFileThatOthersReadToo) {
  MapArchiveWriter writer(0.05);
  const Bytes labels = section_of(of_each_kind());
  writer.add_labels(labels);
  const auto file = std::move(writer).finish();
  ASSERT_TRUE(file);
  EXPECT_EQ(*labels_of_map_archive(*file), labels);
  EXPECT_EQ(read_map_archive(*file)->labels, labels);
  EXPECT_TRUE(labels_of_map_archive(*MapArchiveWriter(0.05).finish())->empty());
  Bytes damaged = *file;
  damaged[damaged.size() / 2] ^= 1;
  EXPECT_EQ(labels_of_map_archive(damaged).error().code, Code::kMalformed);
  EXPECT_EQ(read_map_archive(damaged).error().code, Code::kMalformed);
}

TEST(LabelSection, RefusesWhatNobodyCouldHaveSaved) {
  const auto refuses = [](std::size_t at, Labels::What what) -> std::optional<Code> {
    auto all = of_each_kind();
    all[at].what = std::move(what);
    all.erase(all.begin() + static_cast<std::ptrdiff_t>(at) + 1, all.end());
    const auto read = read_label_section(section_of(all));
    return read ? std::nullopt : std::optional(read.error().code);
  };
  EXPECT_EQ(refuses(0, Claim{{0, 1}, "chair", {{0, 0, 0}}, "", {}}), Code::kBadRequest);
  EXPECT_EQ(refuses(0, Claim{{4'000'000'000U, 1}, "chair", {{0, 0, 0}}, "", {}}), Code::kBadRequest);
  EXPECT_EQ(refuses(0, Claim{{1, 1}, "", {{0, 0, 0}}, "", {}}), Code::kConflict);
  EXPECT_EQ(refuses(0, Claim{{1, 1}, "a/b", {{0, 0, 0}}, "", {}}), Code::kBadName);
  EXPECT_EQ(refuses(0, Claim{{1, 1}, "chair", {}, "", {}}), Code::kEmpty);
  EXPECT_EQ(refuses(1, Claim{{2, 1}, "chair", {{0, 0, 0}}, "", {}}), Code::kExists);
  Transform skew = Transform::Identity();
  skew.linear()(0, 0) = 2;
  EXPECT_EQ(refuses(0, Claim{{1, 1}, "chair", {{0, 0, 0}}, "", {"robot1", "odom", skew}}), Code::kBadTransform);
  EXPECT_EQ(refuses(0, Claim{{1, 1}, "chair", {{0, 0, 0}}, "", {"../robot", "odom", {}}}), Code::kBadName);
  EXPECT_EQ(refuses(3, LabelCorrection::Rename{1, "Tür"}), Code::kExists);
  EXPECT_EQ(refuses(3, LabelCorrection::Rename{7, "x"}), Code::kNotFound);
  EXPECT_EQ(refuses(4, LabelCorrection::Reassign{{1, 9}, {2, 2}}), Code::kNotFound);
  EXPECT_EQ(refuses(6, LabelCorrection::Undo{"l1", true}), Code::kConflict);
  EXPECT_EQ(refuses(6, LabelCorrection::Undo{"nobody", false}), Code::kNotFound);
  auto twice = of_each_kind();
  twice[1].id = "l1";
  EXPECT_EQ(read_label_section(section_of(twice)).error().code, Code::kExists);
  twice[1].id = "";
  EXPECT_EQ(read_label_section(section_of(twice)).error().code, Code::kBadName);
  std::swap(twice[0], twice[1]);
  EXPECT_FALSE(read_label_section(section_of(twice)));
}

RC_GTEST_PROP(LabelSection, AnyDamageIsReadOrRefused, ()) {
  Bytes bytes = section_of(of_each_kind());
  bytes[*rc::gen::inRange<std::size_t>(0, bytes.size())] = *rc::gen::arbitrary<std::uint8_t>();
  bytes.resize(*rc::gen::inRange<std::size_t>(0, bytes.size() + 1));
  if (const auto read = read_label_section(bytes)) RC_ASSERT(section_of(*read) == bytes);
}

TEST(LabelsToLoad, AllOfThemWhereNobodyLabelledAnything) {
  const auto loaded = labels_to_load(of_each_kind(), Labels(0.05));
  ASSERT_TRUE(loaded);
  EXPECT_EQ(section_of(*loaded), section_of(of_each_kind()));
}

TEST(LabelsToLoad, ThemselvesAreHereAlready) {
  const auto loaded = labels_to_load(of_each_kind(), folded(of_each_kind()));
  ASSERT_TRUE(loaded);
  EXPECT_TRUE(loaded->empty());
  auto other = of_each_kind();
  other[1].content = 5;
  EXPECT_EQ(labels_to_load(other, folded(of_each_kind())).error().code, Code::kExists);
}

TEST(LabelsToLoad, WhatHoldsFollowsOnOursByName) {
  std::vector<LabelCorrection> mine{correction(1, Claim{{1, 1}, "Tür", {{1, 1, 1}}, "", {}}),
                                    correction(2, Claim{{2, 1}, "table", {{2, 1, 1}}, "", {}})};
  mine[0].id = "m1";
  mine[1].id = "m2";
  const Labels ours = folded(mine);
  const auto loaded = labels_to_load(of_each_kind(), ours);
  ASSERT_TRUE(loaded) << loaded.error().message;
  ASSERT_EQ(loaded->size(), 3U);
  const auto& chair = std::get<Claim>((*loaded)[0].what);
  EXPECT_EQ(chair.class_name, "stool");
  EXPECT_EQ(chair.of, (InstanceId{3, 1}));
  EXPECT_EQ(chair.anchor.agent, "robot1");
  const auto& door = std::get<Claim>((*loaded)[1].what);
  EXPECT_EQ(door.class_name, "");
  EXPECT_EQ(door.of, (InstanceId{1, 2}));  // 1 is given
  EXPECT_EQ(door.edit_id, "asset-x");
  EXPECT_EQ(std::get<Claim>((*loaded)[2].what).of, (InstanceId{1, 3}));  // was reassigned
  auto all = mine;
  all.insert(all.end(), loaded->begin(), loaded->end());
  EXPECT_TRUE(labels_to_load(of_each_kind(), folded(all))->empty());
}

}  // namespace
}  // namespace concord

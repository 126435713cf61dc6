#include "merge/loaded_corrections.hpp"

#include <gtest/gtest.h>

namespace concord {
namespace {

/// One voxel in each of so many bricks.
Correction scattered_edit(std::int64_t revision, std::int32_t bricks) {
  Correction::Edit edit{EditRequest::Op::kAdd, {}, {}};
  constexpr std::int32_t kSide = 4000;  // bricks within the bounds
  for (std::int32_t i = 0; i < bricks; ++i) {
    edit.added.push_back({8 * (i / kSide) - 16000, 8 * (i % kSide) - 16000, static_cast<std::int32_t>(revision)});
  }
  return {revision, "edit" + std::to_string(revision), "eva", 1, 1, std::move(edit)};
}

TEST(LoadedCorrections, EditsThatLieInMoreBricksThanAreKeptAreRefused) {
  MapArchive archive;
  archive.resolution = 0.1;
  for (int i = 1; i <= 2; ++i) archive.corrections.push_back(scattered_edit(i, 1'000'000));
  const People people(archive.resolution);
  const auto weight = [](const std::string&) { return 1; };
  const Loading loading{archive, "load", 7, 1};
  EXPECT_EQ(corrections_to_load(loading, people, {}, weight)->size(), 2u);
  archive.corrections.push_back(scattered_edit(3, 1));
  EXPECT_EQ(corrections_to_load(loading, people, {}, weight).error().code, Code::kTooLarge);
}

}  // namespace
}  // namespace concord

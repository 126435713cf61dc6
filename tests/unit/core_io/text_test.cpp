#include "core/text.hpp"

#include <string>

#include <gtest/gtest.h>

namespace concord {
namespace {

TEST(Text, NamesOfZonesAreWhatAReaderSees) {
  for (const char* fine :
       {"dock", "Line 3 €", "Pit by the gate", "安全区", "منطقة", "v1.2", "a..b", "Zoë's", "é", "🚧 pit"}) {
    EXPECT_TRUE(is_title(fine)) << fine;
    EXPECT_TRUE(is_request_id(fine)) << fine;
    EXPECT_TRUE(is_author(fine)) << fine;
  }
}

TEST(Text, WhatCannotBeSeenIsNoPartOfIt) {
  for (const char* unseen : {"a\nb", "a\x7f", "\u0085", "a\u202Eb", "a\u2066b", "a\u200Bb", "a\u200F", "\uFEFFa",
                             "a\u00ADb", "a\u2028b", "\U000E0041", "\u3164", "a\u2060b"}) {
    EXPECT_TRUE(is_utf8(unseen));
    EXPECT_FALSE(is_printable(unseen)) << unseen;
    EXPECT_FALSE(is_title(unseen)) << unseen;
    EXPECT_FALSE(is_request_id(unseen)) << unseen;
    EXPECT_FALSE(is_author(unseen)) << unseen;
  }
}

TEST(Text, NoSpaceStandsAtAnEnd) {
  for (const char* spaced : {" a", "a ", " ", "\u00A0a", "a\u3000", "a\u2003"}) {
    EXPECT_TRUE(is_printable(spaced)) << spaced;
    EXPECT_FALSE(is_title(spaced)) << spaced;
    EXPECT_FALSE(is_request_id(spaced)) << spaced;
    EXPECT_FALSE(is_author(spaced)) << spaced;
  }
}

TEST(Text, TitlesArePathsToNothing) {
  for (const char* path : {"", ".", "..", "...", "a/b", "a\\b", "../a"}) EXPECT_FALSE(is_title(path)) << path;
  EXPECT_TRUE(is_title("..a"));
}

TEST(Text, LimitsAreInBytes) {
  EXPECT_TRUE(is_title(std::string(80, 'x')));
  EXPECT_FALSE(is_title(std::string(81, 'x')));
  EXPECT_FALSE(is_title(std::string(79, 'x') + "é"));
  EXPECT_TRUE(is_author(""));
  EXPECT_FALSE(is_author(std::string(81, 'x')));
  EXPECT_FALSE(is_request_id(""));
}

TEST(Text, IsCutBetweenCharacters) {
  EXPECT_EQ(cut_to("abc", 3), "abc");
  EXPECT_EQ(cut_to("abc", 2), "ab");
  EXPECT_EQ(cut_to("aé", 2), "a");
  EXPECT_EQ(cut_to("aé", 3), "aé");
  EXPECT_EQ(cut_to("é", 1), "");
  EXPECT_EQ(cut_to("a\xF0\x9F\x98\x80z", 4), "a");
  EXPECT_EQ(cut_to("a\xF0\x9F\x98\x80z", 5), "a\xF0\x9F\x98\x80");
  EXPECT_EQ(cut_to("", 5), "");
}

TEST(Text, WhatIsNoUtf8IsNoText) {
  for (const char* broken : {"\xFF", "\xC0\xAF", "\xE2\x82", "\xED\xA0\x80", "\xF5\x80\x80\x80"}) {
    EXPECT_FALSE(is_utf8(broken));
    EXPECT_FALSE(is_line(broken));
    EXPECT_FALSE(is_printable(broken));
  }
}

/// What was made before a name was checked as now stays readable.
TEST(Text, ALineHasNoAsciiControls) {
  EXPECT_TRUE(is_line(" a\u202Eb "));
  EXPECT_FALSE(is_line("a\tb"));
  EXPECT_FALSE(is_line("a\x7f"));
}

}  // namespace
}  // namespace concord

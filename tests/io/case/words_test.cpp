// Suggestions for a mistyped word, quotes of text and names of files against what they must be.

#include "io/words.hpp"

#include <gtest/gtest.h>

namespace kerf::words_test {
namespace {

TEST(Words, SuggestsTheNearest) {
  const std::vector<std::string> known = {"young", "poisson", "state"};
  EXPECT_EQ(suggest("youg", known), "did you mean \"young\"?");
  EXPECT_EQ(suggest("yuong", known), "did you mean \"young\"?");
  EXPECT_EQ(suggest("possion", known), "did you mean \"poisson\"?");
  EXPECT_EQ(suggest("density", known), "known: young, poisson, state");
  EXPECT_EQ(suggest(std::string(100000, 'y'), known), "known: young, poisson, state");
  EXPECT_EQ(suggest("a", {}), "none is known here");
  // Words of other programs, where kerf has one here.
  EXPECT_EQ(suggest("E", known), "it is called \"young\" here");
  EXPECT_EQ(suggest("Poisson_Ratio", known), "it is called \"poisson\" here");
  EXPECT_EQ(suggest("diameter", std::vector<std::string>{"center", "radius"}),
            "it is called \"radius\" here: half of the diameter");
  EXPECT_EQ(suggest("diameter", known), "known: young, poisson, state");
  // Names of a stranger may hold what a terminal obeys.
  const std::vector<std::string> odd{"a\x1b[2J", std::string("b\0\n\x7f", 4)};
  EXPECT_EQ(suggest("density", odd), "known: a [2J, b   ");
  EXPECT_EQ(suggest("a [2J", odd), "did you mean \"a [2J\"?");
}

TEST(Words, QuotesOnOneLine) {
  EXPECT_EQ(quote("a\nb\tc"), "\"a b c\"");
  EXPECT_EQ(quote(std::string(100, 'a')), "\"" + std::string(60, 'a') + "...\"");
  // A cut never leaves half a character.
  EXPECT_EQ(quote(std::string(59, 'a') + "\xC3\xA9\xC3\xA9"), "\"" + std::string(59, 'a') + "...\"");
}

TEST(Words, SafeNames) {
  for (const char* name : {"c", "crack_1", "a.b-C"}) EXPECT_TRUE(is_safe_name(name)) << name;
  for (const char* name : {"", "a b", "a/b", "hole:h", "\xC3\xA9"}) EXPECT_FALSE(is_safe_name(name)) << name;
  EXPECT_FALSE(is_safe_name(std::string(101, 'a')));
}

}  // namespace
}  // namespace kerf::words_test

// Titles in lines and the places of a figure and its bar, with letters of a known width.

#include "plot/figure/layout.hpp"

#include "io/text.hpp"
#include "tests/support/sample.hpp"

namespace kerf::layout_test {
namespace {

/// Every letter half as wide as high.
double letters(const std::string& text, const Font& font) {
  double count = 0;
  for (const char c : text) count += (static_cast<unsigned char>(c) & 0xC0) != 0x80;
  return 0.5 * font.size * count;
}

TEST(Wrap, FewLinesThenLargeLetters) {
  const Lines one = wrap("short", {40}, {1000, 20, 3}, letters);
  EXPECT_EQ(one.text, std::vector<std::string>{"short"});
  EXPECT_EQ(one.font.size, 40);
  const Lines smaller = wrap("ten letter", {40}, {180, 20, 3}, letters);
  EXPECT_EQ(smaller.text.size(), 1u);
  EXPECT_EQ(smaller.font.size, 36);
  const Lines two = wrap("ten letter", {40}, {120, 20, 3}, letters);
  EXPECT_EQ(two.text, (std::vector<std::string>{"ten", "letter"}));
  EXPECT_EQ(two.font.size, 40);
  EXPECT_TRUE(wrap("", {40}, {100, 20, 3}, letters).text.empty());
}

TEST(Wrap, CutsBetweenLettersAndSaysSo) {
  std::string text;
  for (int i = 0; i < 400; ++i) text += "σ";
  const Lines cut = wrap(text, {40}, {205, 20, 2}, letters);
  ASSERT_EQ(cut.text.size(), 2u);
  EXPECT_EQ(cut.font.size, 20);
  for (const auto& line : cut.text) {
    EXPECT_LE(letters(line, cut.font), 205);
    EXPECT_EQ(clean_text(line), line) << "no letter is cut in half";
  }
  EXPECT_TRUE(cut.text[1].ends_with(" …"));
}

TEST(LayOut, EqualScalesAndTheBarBesideOrBelow) {
  const auto of = [](const Vec2& size) {
    const Picture picture = test::grid({0, 0}, size, 2, 2, [](const Vec2& p) { return p.x(); });
    return lay_out(picture, limits(picture), letters);
  };
  const Layout square = of({3, 3});
  EXPECT_TRUE(square.beside);
  EXPECT_GT(square.bar.x, square.plot.x + square.plot.width);
  EXPECT_NEAR((square.place({3, 0}) - square.place({0, 0})).x(), 3 * square.scale, 1e-9);
  EXPECT_NEAR((square.place({0, 0}) - square.place({0, 3})).y(), 3 * square.scale, 1e-9);
  const Layout strip = of({30, 3});
  EXPECT_FALSE(strip.beside);
  EXPECT_GT(strip.bar.y, strip.plot.y + strip.plot.height);
  EXPECT_NEAR(strip.width, 1600, 2);
  EXPECT_LT(of({3, 30}).width, 1000);
}

}  // namespace
}  // namespace kerf::layout_test

// Cases that are no files: functions stand in place of expressions.

#include "io/case/expression.hpp"
#include "io/document.hpp"
#include "io/kept.hpp"
#include "tests/io/case/case_files.hpp"

#include <cmath>

namespace kerf::functions_test {
namespace {

/// The square with a traction on its top, and what it does along x.
Case with_traction(const Expression& along_x) {
  const TemporaryFolder folder;
  Node root = read_document(folder.write("a.toml", square + "[[boundary]]\non = 'top'\ntraction = ['f', 1]\n"));
  Node& field = root.entries.back().value.items.at(0).entries.at(1).value.items.at(0);
  field.kind = Node::Kind::Function;
  field.function = along_x;
  return read_case(std::move(root), {"made up", folder.path, "a dictionary"});
}

std::string said(const Case& c, const Vec2& x) {
  try {
    c.scene.tractions.at(0).value(x, {0, 1});
  } catch (const Error& e) {
    EXPECT_EQ(e.fault, Fault::Usage);
    const std::string message = e.what();
    return message.substr(message.find("a.toml"));
  }
  return "nothing";
}

TEST(Functions, StandInPlaceOfExpressions) {
  const Case c = with_traction([](const Vec2& x, const Vec2& n) { return 2 * x.x() + n.y(); });
  EXPECT_EQ(c.name, "made up");
  EXPECT_EQ(place_of(c, "nothing"), "a dictionary");
  EXPECT_EQ(c.scene.tractions.at(0).value({1.5, 1}, {0, 1}), Vec2(4, 1));
  EXPECT_FALSE(c.scene.tractions[0].value.known()) << "nothing is proved of a black box";
  EXPECT_TRUE(has_functions(*c.document));
  EXPECT_FALSE(has_functions(*read(square).document));
}

TEST(Functions, SayWhereTheyFail) {
  const Case c = with_traction([](const Vec2& x, const Vec2&) {
    if (x.x() > 1) throw Error(Fault::Usage, "no data beyond 1");
    return x.x() < 0 ? std::sqrt(x.x()) : 1 / x.x();
  });
  EXPECT_EQ(said(c, {0.5, 1}), "nothing");
  EXPECT_EQ(said(c, {1.5, 1}), "a.toml:9:13: entry 1 of traction in [[boundary]]: no data beyond 1");
  EXPECT_EQ(
      said(c, {0, 1}),
      "a.toml:9:13: entry 1 of traction in [[boundary]]: the function is not finite (inf) at (0, 1); it must have "
      "a value wherever it is applied");
  EXPECT_NE(said(c, {-1, 0.25}).find("nan) at (-1, 0.25)"), std::string::npos);
}

/// A function in the place of the whole vector is called once for both.
TEST(Functions, GiveBothComponentsOfAVector) {
  const TemporaryFolder folder;
  Node root = read_document(folder.write("a.toml", square + "[[boundary]]\non = 'top'\ntraction = 'f'\n"));
  Node& field = root.entries.back().value.items.at(0).entries.at(1).value;
  field.kind = Node::Kind::Function;
  int calls = 0;
  field.pair = [&](const Vec2& x, const Vec2& n) {
    ++calls;
    return Vec2(2 * x.x(), x.x() > 1 ? infinity : n.y());
  };
  const Case c = read_case(std::move(root), {"made up", folder.path, "a dictionary"});
  calls = 0;
  EXPECT_EQ(c.scene.tractions.at(0).value({0.5, 1}, {0, 1}), Vec2(1, 1));
  EXPECT_EQ(calls, 1);
  EXPECT_FALSE(c.scene.tractions[0].value.known());
  EXPECT_EQ(said(c, {1.5, 1}),
            "a.toml:9:12: traction in [[boundary]]: the function is not finite (inf) at (1.5, 1); it must have a value "
            "wherever it is applied");
}

TEST(Functions, OfNumbersAreNoVectors) {
  const TemporaryFolder folder;
  Node root = read_document(folder.write("a.toml", square + "[[boundary]]\non = 'top'\ntraction = 'f'\n"));
  Node& field = root.entries.back().value.items.at(0).entries.at(1).value;
  field.kind = Node::Kind::Function;
  field.function = [](const Vec2&, const Vec2&) { return 1.0; };
  EXPECT_THROW(read_case(std::move(root), {"made up", folder.path, ""}), Error);
}

TEST(Functions, AreNoValuesOfOtherKeys) {
  const TemporaryFolder folder;
  Node root = read_document(folder.write("a.toml", square));
  root.entries.back().value.entries.at(0).value.kind = Node::Kind::Function;
  try {
    read_case(std::move(root), {"made up", folder.path, ""});
    ADD_FAILURE();
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("a.toml:5:9: young in [material] must be a number, not a function"),
              std::string::npos)
        << e.what();
  }
}

TEST(Functions, AreKeptAsTheirNames) {
  const KeptCase kept = keep(with_traction([](const Vec2&, const Vec2&) { return 1.0; }), {"one", "two"});
  EXPECT_TRUE(kept.text.starts_with(
      "# Not all of it: functions stand here as their names\n# one\n# two\ntitle = \"made up\"\n"))
      << kept.text;
  EXPECT_NE(kept.text.find("traction = [\"f\", 1]\n"), std::string::npos) << kept.text;
  EXPECT_TRUE(kept.files.empty());
}

TEST(Written, TruthIsTold) {
  const std::string text = keep(read(square + "[output]\nvtk = false\npng = true\n"), {}).text;
  EXPECT_NE(text.find("[output]\nvtk = false\npng = true\n"), std::string::npos) << text;
}

// As few digits as read back to the same bits, and still no integer.
TEST(Written, NumbersWithTheDigitsThatTheyNeed) {
  Node node;
  node.kind = Node::Kind::Float;
  const std::vector<std::pair<double, std::string>> numbers = {
      {0.1, "0.1"}, {3.0, "3.0"}, {1e300, "1e+300"}, {1.0 / 3, "0.3333333333333333"}, {infinity, "inf"}};
  for (const auto& [value, text] : numbers) {
    node.number = value;
    EXPECT_EQ(inline_text(node), text);
  }
}

/// What is kept reads back: every character that TOML wants escaped.
TEST(Written, TextsOfAnyCharacters) {
  std::string title = "\"\\";
  for (char c = 1; c < 32; ++c) title += c;
  title += "\x7f\u00e9";
  const TemporaryFolder folder;
  Case c = read(square);
  c.title = title;
  EXPECT_EQ(read_case(folder.write("b.toml", keep(c, {}).text)).title, title);
}

}  // namespace
}  // namespace kerf::functions_test

// Rare mistakes of case files, and the case that is kept beside its results.

#include "io/kept.hpp"
#include "tests/io/case/case_files.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace kerf::corners_test {
namespace {

/// A first line that is no line of a case file.
std::string first_line(const std::string& line) {
  const std::string message = error(line + "\n" + square);
  EXPECT_EQ(message.find("a.toml:1:"), 0u) << message;
  const std::size_t end = message.find(": ");
  return end == std::string::npos ? message : message.substr(end + 2);
}

TEST(Corners, LinesThatAreNoToml) {
  EXPECT_EQ(first_line("mesh size = 1"), "between a key and its value stands =: key = value; a key is one word");
  EXPECT_EQ(first_line("title: 'a'"), "a key and its value are joined by =, not by a colon");
  EXPECT_EQ(first_line("gr\u00f6\u00dfe = 1"), "keys have English letters, digits, _ and -");
  EXPECT_EQ(first_line("mesh = { 1, 2 }"), "in braces stand keys with values: { x = 0, y = 1 }");
  EXPECT_EQ(first_line("title = '\xff'"), "the file is no UTF-8 text; save it as UTF-8");
  EXPECT_EQ(first_line("title = \u201ca\u201d"), "\u201c is no quotation mark of TOML; write \"...\"");
  EXPECT_EQ(first_line("a = \u22121"), "this minus sign is a dash; write -");
  EXPECT_EQ(first_line("a =\u00a01"), "there is a space that is none (U+00A0); type it anew");
  EXPECT_EQ(first_line("a = 1, b = 2"), "one key per line, without a comma between them");
  EXPECT_EQ(first_line("title = \"a\\q\""), "a \\ in a text is written \\\\, or the text stands in '...'");
  EXPECT_EQ(first_line("a = 1 // one"), "a comment begins with #");
  EXPECT_EQ(first_line("a = 1;"), "entries of a list are separated by commas; at the end of a line stands nothing");
  EXPECT_EQ(first_line("a = 'b';"), "no ; is needed at the end of a line");
  EXPECT_EQ(first_line("a = [1, 2]]"), "one ] too many");
  EXPECT_EQ(first_line("a = (1, 2)"), "a list stands in brackets: [0, 1]");
  EXPECT_EQ(first_line("a = True"), "true and false are written in small letters");
  EXPECT_EQ(first_line("a = "), "a value is missing");
  EXPECT_EQ(first_line("a = .5"), "a number needs a digit before its point: 0.5");
  EXPECT_EQ(first_line("a = 5."), "a number needs a digit after its point: 5.0");
  EXPECT_EQ(first_line("a = 05"), "a number does not begin with 0");
}

/// What stands where a text should.
TEST(Corners, ValuesOfOtherKinds) {
  const auto title = [](const std::string& value) { return first_line("title = " + value); };
  for (const auto& [value, called] : {std::pair("true", "true"), std::pair("false", "false"),
                                      std::pair("2020-01-01", "a date"), std::pair("{ a = 1 }", "a table")})
    EXPECT_NE(title(value).find(std::string("not ") + called), std::string::npos) << title(value);
}

TEST(Corners, TooMuch) {
  std::string define = "[define]\n";
  for (int k = 0; k < 20000; ++k) define += fmt::format("a{} = 1\n", k);
  EXPECT_NE(error(square + define).find("[define] holds at most "), std::string::npos);
  const std::string sum(200000, '+');
  EXPECT_NE(error(square + "[[boundary]]\non = 'top'\ntraction = [0, 'x" + sum + "x']\n").find("characters; at most "),
            std::string::npos);
  EXPECT_NE(error(square + "[define]\na = true\n").find("must be a number or an expression in a string, \"1 + x\""),
            std::string::npos);
}

TEST(Corners, OptionsOfPetsc) {
  // Files, sockets and libraries stay out: of a solver's options a case may give those with plain values.
  const auto options = [&](const std::string& words) {
    return square + "[solver]\nbackend = 'petsc'\npetsc = '" + words + "'\n";
  };
  for (const char* words :
       {"-ksp_type gmres -ksp_rtol 1e-8", "-pc_type lu -pc_factor_mat_solver_type mumps",
        "-mat_mumps_icntl_14 30 -log_view", "-ksp_view -ksp_monitor -options_left", "-ksp_rtol -1", ""})
    EXPECT_EQ(read(options(words)).petsc, words);
  for (const char* words :
       {"-ksp_view_mat binary:f", "-ksp_view_mat binary", "-ksp_monitor ascii:f", "-options_file f", "-log_view :f",
        "-dll_append f", "-pc_type /tmp/x", "-ksp_type a:b", "plain", "-ksp_rtol 1 2", "-info", "-viewer_socket_port 1",
        "-mat_mumps_ooc_tmpdir x", "-ksp_type ../x", "-log_view x", "-ksp_$(x)"})
    EXPECT_NE(error(options(words)).find("is no option that a case may give"), std::string::npos) << words;
  EXPECT_EQ(read(square + "[solver]\nbackend = 'petsc'\npetsc = '-ksp_monitor'\n").petsc, "-ksp_monitor");
  EXPECT_NE(
      error(square + "[solver]\npetsc = '-ksp_monitor'\n").find("petsc in [solver] goes with backend = \"petsc\""),
      std::string::npos);
}

TEST(Kept, FilesThatAreNotReadAsCases) {
  const TemporaryFolder folder;
  folder.write("p.csv", "x,y\n0.5,0.25\n");
  const auto path =
      folder.write("my case.toml",
                   "[material]\nyoung = 10\npoisson = 0.1\nday = 2020-02-29\nat = 07:32:00\nno_key = true\n"
                   "[[probe]]\nname = 'p \"q\" \\\\ r'\nfile = 'p.csv'\n");
  const std::vector<std::string> overrides = {"material.young=2.5", "material.tag=\"a\\u0001b\\\\c\""};
  const KeptCase kept = keep_file(path, overrides);
  EXPECT_EQ(kept.text.find("title = \"my case\"\n"), 0u) << kept.text;
  for (const char* line :
       {"young = 2.5\n", "day = 2020-02-29\n", "at = 07:32:00\n", "no_key = true\n", "tag = \"a\\u0001b\\\\c\"\n",
        "name = \"p \\\"q\\\" \\\\\\\\ r\"\n", "file = \"input/1_p.csv\"\n"})
    EXPECT_NE(kept.text.find(line), std::string::npos) << line << kept.text;
  ASSERT_EQ(kept.files.size(), 1u);
  EXPECT_EQ(kept.files[0].first, "input/1_p.csv");
  EXPECT_EQ(kept.files[0].second, "x,y\n0.5,0.25\n");
  // Read again it is the same.
  const auto again = folder.write("again.toml", kept.text);
  folder.write("input_p", "");
  std::filesystem::create_directory(folder.path / "input");
  std::filesystem::copy_file(folder.path / "p.csv", folder.path / "input" / "1_p.csv");
  std::string twice = keep_file(again, {}).text;
  const std::size_t at = twice.find("input/input/");
  if (at != std::string::npos) twice.replace(at, 12, "input/");
  EXPECT_EQ(twice, kept.text);
  // The title of the file, if it has one.
  EXPECT_EQ(keep_file(folder.write("b.toml", "a = 1\ntitle = 'T'\n"), {}).text.find("title = \"T\"\n"), 0u);
}

/// Of a design that a case names only the body is kept, and two files of one name get names of their own.
TEST(Kept, DesignsAndFilesOfOneName) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.path / "other");
  folder.write("design.toml", "title = 'old'\n" + square + "[mesh]\nsize = 0.1\n");
  folder.write("p.csv", "x,y\n0.5,0.25\n");
  folder.write("other/p.csv", "x,y\n1.5,0.75\n");
  const auto path = folder.write("a.toml",
                                 "[domain]\nfile = 'design.toml'\n[[probe]]\nname = 'a'\nfile = 'p.csv'\n"
                                 "[[probe]]\nname = 'b'\nfile = 'other/p.csv'\n"
                                 "[[probe]]\nname = 'c'\nfile = 'other/../p.csv'\n");
  const KeptCase kept = keep_file(path, {});
  std::map<std::string, std::string> files(kept.files.begin(), kept.files.end());
  ASSERT_EQ(files.size(), 3u);
  EXPECT_EQ(files["input/2_p.csv"], "x,y\n0.5,0.25\n");
  EXPECT_EQ(files["input/3_p.csv"], "x,y\n1.5,0.75\n");
  EXPECT_NE(files["input/1_design.toml"].find("outline = "), std::string::npos);
  EXPECT_EQ(files["input/1_design.toml"].find("[mesh]"), std::string::npos);
  EXPECT_EQ(files["input/1_design.toml"].find("title"), std::string::npos);
}

/// Names that a shell, a folder or a login would take for something else stay behind; the end says what kind it is.
TEST(Kept, FilesHaveNamesOfKerfsOwn) {
  const TemporaryFolder folder;
  for (const auto& [name, copy] : {std::pair<std::string, std::string>{".bashrc", "1_.bashrc"},
                                   {"$(touch x).csv", "1___touch_x_.csv"},
                                   {"-rf", "1_-rf"},
                                   {"a;b|c`d`.csv", "1_a_b_c_d_.csv"},
                                   {"3_p.csv", "1_p.csv"},
                                   {std::string(200, 'a') + ".csv", "1_" + std::string(56, 'a') + ".csv"}}) {
    folder.write(name, "x,y\n0.5,0.25\n");
    const KeptCase kept = keep_file(folder.write("a.toml", "[[probe]]\nname = 'p'\nfile = '" + name + "'\n"), {});
    ASSERT_EQ(kept.files.size(), 1u);
    EXPECT_EQ(kept.files[0].first, "input/" + copy);
    EXPECT_NE(kept.text.find("\"input/" + copy + "\""), std::string::npos) << kept.text;
  }
}

}  // namespace
}  // namespace kerf::corners_test

// Numbers, UTF-8 and base64 (RFC 4648) as text against known answers; files are written whole or not at all, and what
// is no regular file is not waited for.

#include "io/text.hpp"

#include "io/files.hpp"
#include "tests/support/sample.hpp"

#include <sys/resource.h>
#include <sys/stat.h>

#include <csignal>
#include <fstream>

namespace kerf::text_test {
namespace {

TEST(Text, SixDigits) {
  EXPECT_EQ(six(1.0 / 3), "0.333333");
  EXPECT_EQ(six(-0.0), "0");
  EXPECT_EQ(six(1e-300), "1e-300");
  EXPECT_EQ(six(std::nan("")), "-");
}

TEST(Text, CleanTextIsValidAndOnOneLine) {
  EXPECT_EQ(clean_text("a\nb\tc"), "a b c");
  EXPECT_EQ(clean_text("σ ≥ 0 – 𝛼"), "σ ≥ 0 – 𝛼");
  EXPECT_EQ(clean_text("x\xffy"), "x\xEF\xBF\xBDy");
  EXPECT_EQ(clean_text("\xe2\x82"), "\xEF\xBF\xBD\xEF\xBF\xBD");              // cut short
  EXPECT_EQ(clean_text("\xc0\xaf"), "\xEF\xBF\xBD\xEF\xBF\xBD");              // overlong
  EXPECT_EQ(clean_text("\xf0\x8f\xbf\xbf").find('\xf0'), std::string::npos);  // overlong, too
  EXPECT_EQ(clean_text("\xed\xa0\x80").find('\xed'), std::string::npos);      // surrogate
  EXPECT_EQ(clean_text("\xf4\x90\x80\x80").find('\xf4'), std::string::npos);  // beyond U+10FFFF
}

TEST(Text, EscapeHtml) {
  EXPECT_EQ(escape_html("<a href=\"x\">'&'</a>"), "&lt;a href=&quot;x&quot;&gt;&#39;&amp;&#39;&lt;/a&gt;");
}

TEST(Text, Base64OfTheStandard) {  // RFC 4648, section 10
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foob"), "Zm9vYg==");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64("\xff\xff\xff"), "////");
}

TEST(Files, WriteThenReadAndReplace) {
  const test::Folder folder;
  const auto path = folder.path / "a.txt";
  write_file(path, std::string("a\0b", 3));
  EXPECT_EQ(read_file(path), std::string("a\0b", 3));
  write_file(path, "new");
  EXPECT_EQ(read_file(path), "new");
  EXPECT_FALSE(std::filesystem::exists(folder.path / "a.txt.part"));
}

// None of these is waited for, or read without an end.
TEST(Files, OnlyRegularFilesOfABoundedSizeAreRead) {
  const test::Folder folder;
  const auto complaint = [](const std::filesystem::path& path, std::uintmax_t most) -> std::string {
    try {
      read_file(path, most);
    } catch (const Error& error) {
      EXPECT_EQ(error.fault, Fault::Files);
      return error.what();
    }
    return "none";
  };
  const auto in = [&](const std::string& name) { return folder.path / name; };
  const auto said = [&](const std::string& name, const std::string& why) {
    return "cannot read '" + in(name).string() + "': " + why;
  };
  ASSERT_EQ(mkfifo(in("pipe").c_str(), 0600), 0);
  std::filesystem::create_symlink("pipe", in("link"));
  std::filesystem::create_symlink("/dev/zero", in("endless"));
  std::filesystem::create_directory(in("folder"));
  for (const char* name : {"pipe", "link", "endless"})
    EXPECT_EQ(complaint(in(name), largest_input), said(name, "it is no regular file"));
  EXPECT_EQ(complaint(in("folder"), largest_input), said("folder", "it is a folder"));
  // A file full of holes takes no space on the disk.
  write_file(in("large"), "x");
  std::filesystem::resize_file(in("large"), largest_input + 1);
  EXPECT_EQ(complaint(in("large"), largest_input), said("large", "it is too large; at most 4096 MiB are read"));
  write_file(in("small"), std::string(1 << 20, 'x'));
  EXPECT_EQ(complaint(in("small"), (1 << 20) - 1), said("small", "it is too large; at most 0 MiB are read"));
  EXPECT_EQ(read_file(in("small"), 1 << 20).size(), std::size_t{1 << 20});
}

TEST(Files, FailureNamesThePathAndLeavesTheOldFile) {
  const test::Folder folder;
  for (const auto& path : {folder.path, folder.path / "no" / "a.txt"}) {
    try {
      write_file(path, "x");
      FAIL() << path;
    } catch (const Error& error) {
      EXPECT_EQ(error.fault, Fault::Files);
      EXPECT_NE(std::string(error.what()).find(path.string()), std::string::npos);
    }
  }
  EXPECT_THROW(read_file(folder.path / "absent"), Error);
  // A disk that is full, or what stands for it: the old file stays, no half file remains.
  const auto path = folder.path / "a.txt";
  write_file(path, "old");
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{1000, before.rlim_max};
  setrlimit(RLIMIT_FSIZE, &small);
  EXPECT_THROW(write_file(path, std::string(100000, 'x')), Error);
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(read_file(path), "old");
  EXPECT_FALSE(std::filesystem::exists(folder.path / "a.txt.part"));
}

// Who may write into the folder might put them there.
TEST(Files, LinksAndPipesInTheWayAreRemoved) {
  const test::Folder folder;
  const std::filesystem::path path = folder.path / "a.txt", part = folder.path / "a.txt.part",
                              victim = folder.path / "victim";
  write_file(victim, "mine");
  std::filesystem::create_symlink(victim, part);
  write_file(path, "first");
  ASSERT_EQ(mkfifo(part.c_str(), 0600), 0);
  write_file(path, "second");
  std::filesystem::create_symlink(victim, part);
  std::filesystem::remove(path);
  std::filesystem::create_symlink(victim, path);
  write_file(path, "third");
  EXPECT_EQ(read_file(path), "third");
  EXPECT_EQ(read_file(victim), "mine");
  EXPECT_FALSE(std::filesystem::is_symlink(path));
}

TEST(Files, AFolderIsWrittenIntoByOneRunAtATime) {
  const test::Folder folder, other;
  const auto refusal = [](FolderLock& lock, const std::filesystem::path& path) {
    try {
      lock.take(path);
    } catch (const Error& error) {
      EXPECT_EQ(error.fault, Fault::Files);
      return std::string(error.what());
    }
    return std::string();
  };
  FolderLock second;
  {
    FolderLock first;
    first.take(folder.path);
    first.take(folder.path);  // held already
    EXPECT_EQ(refusal(second, folder.path), "another kerf is writing into '" + folder.path.string() +
                                                "'; wait until it is done, or choose another folder with --output");
    EXPECT_EQ(refusal(second, other.path), "");
    first.take(other.path);  // it keeps what it has
    FolderLock third;
    EXPECT_NE(refusal(third, folder.path), "");
    EXPECT_EQ(refusal(third, folder.path / "absent"), "");  // writing will tell
  }
  FolderLock third;
  EXPECT_EQ(refusal(third, folder.path), "") << "the first is gone";
}

}  // namespace
}  // namespace kerf::text_test

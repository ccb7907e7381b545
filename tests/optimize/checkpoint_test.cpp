// Checkpoints come back bit for bit; every truncation and every flipped bit is refused; a kill leaves the old or the
// new one.

#include "optimize/checkpoint.hpp"

#include "base/read_whole_file.hpp"
#include "kerf/types.hpp"
#include "tests/support/folder.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <bit>
#include <cstring>
#include <fstream>
#include <limits>

namespace kerf::checkpoint_test {
namespace {

Checkpoint sample() {
  Checkpoint c;
  c.fingerprint = "0123456789abcdef";
  c.texts = {{"", "nameless"}, {"method", "level-set"}, {"note", std::string("a\0b\n", 4)}};
  c.numbers["empty"] = Eigen::VectorXd();
  c.numbers["phi"] = Eigen::VectorXd::LinSpaced(7, -1, 1 + 1e-16);
  c.numbers["odd"] = Eigen::Vector4d(nan, -0.0, std::numeric_limits<double>::denorm_min(), -infinity);
  return c;
}

void expect_same(const Checkpoint& a, const Checkpoint& b) {
  EXPECT_EQ(a.fingerprint, b.fingerprint);
  EXPECT_EQ(a.texts, b.texts);
  ASSERT_EQ(a.numbers.size(), b.numbers.size());
  for (const auto& [name, values] : a.numbers) {
    ASSERT_TRUE(b.numbers.count(name)) << name;
    const Eigen::VectorXd& other = b.numbers.at(name);
    ASSERT_EQ(values.size(), other.size()) << name;
    for (Eigen::Index i = 0; i < values.size(); ++i)
      EXPECT_EQ(std::bit_cast<std::uint64_t>(values[i]), std::bit_cast<std::uint64_t>(other[i])) << name << i;
  }
}

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}
void put(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

/// What reading complains about, without the path.
std::string complaint(const std::filesystem::path& path) {
  try {
    read_checkpoint(path);
  } catch (const Error& e) {
    EXPECT_EQ(e.fault, Fault::Files);
    std::string text = e.what();
    const std::size_t at = text.find(path.string());
    EXPECT_NE(at, std::string::npos) << text;
    return at == std::string::npos ? text : text.erase(at, path.string().size());
  }
  return "none";
}

TEST(Checkpoint, ComesBackBitForBitAndTheSameBytesEveryTime) {
  const test::Folder folder;
  const auto path = folder.path / "checkpoint.bin";
  EXPECT_FALSE(read_checkpoint(path));
  write_checkpoint(path, sample());
  const std::string first = bytes_of(path);
  const auto back = read_checkpoint(path);
  ASSERT_TRUE(back);
  expect_same(sample(), *back);
  write_checkpoint(path, *back);
  EXPECT_EQ(bytes_of(path), first);
  EXPECT_FALSE(std::filesystem::exists(folder.path / "checkpoint.bin.part"));
  write_checkpoint(path, {});
  const auto none_in_it = read_checkpoint(path);
  ASSERT_TRUE(none_in_it);
  expect_same({}, *none_in_it);
}

TEST(Checkpoint, EveryTruncationIsRefused) {
  const test::Folder folder;
  const auto path = folder.path / "checkpoint.bin";
  write_checkpoint(path, sample());
  const std::string whole = bytes_of(path);
  for (std::size_t length = 0; length < whole.size(); ++length) {
    put(path, whole.substr(0, length));
    EXPECT_EQ(complaint(path),
              "the checkpoint '' is cut off after " + std::to_string(length) + " bytes; start without --resume");
  }
  put(path, whole + 'x');
  EXPECT_EQ(complaint(path), "the checkpoint '' is damaged (it is longer than it says); start without --resume");
}

TEST(Checkpoint, EveryFlippedBitIsRefused) {
  const test::Folder folder;
  const auto path = folder.path / "checkpoint.bin";
  write_checkpoint(path, sample());
  const std::string whole = bytes_of(path);
  for (std::size_t i = 0; i < whole.size(); ++i)
    for (int bit = 0; bit < 8; ++bit) {
      std::string flipped = whole;
      flipped[i] = static_cast<char>(flipped[i] ^ (1 << bit));
      put(path, flipped);
      const std::string said = complaint(path);
      const char* expected = i < 8 ? "no checkpoint of kerf" : i < 12 ? "format" : i < 20 ? "" : "checksum is wrong";
      EXPECT_NE(said, "none") << i;
      EXPECT_NE(said.find(expected), std::string::npos) << i << ' ' << said;
    }
}

TEST(Checkpoint, LyingLengthsWithARightChecksumDoNotAllocateOrOverrun) {
  const test::Folder folder;
  const auto path = folder.path / "checkpoint.bin";
  write_checkpoint(path, sample());
  const std::string whole = bytes_of(path);
  for (std::size_t i = 20; i + 16 <= whole.size(); ++i) {
    std::string wrong = whole;
    const std::uint64_t huge = ~std::uint64_t{0} >> (i % 9);
    std::memcpy(wrong.data() + i, &huge, 8);
    std::uint64_t sum = 14695981039346656037u;
    for (std::size_t k = 0; k + 8 < wrong.size(); ++k)
      sum = (sum ^ static_cast<unsigned char>(wrong[k])) * 1099511628211u;
    std::memcpy(wrong.data() + wrong.size() - 8, &sum, 8);
    put(path, wrong);
    try {
      read_checkpoint(path);  // some of these are names and numbers, and right
    } catch (const Error& e) {
      EXPECT_EQ(e.fault, Fault::Files);
      EXPECT_NE(std::string(e.what()).find("is damaged"), std::string::npos) << e.what();
    }
  }
}

TEST(Checkpoint, PlacesThatCannotHoldOneAreNamed) {
  const test::Folder folder;
  EXPECT_EQ(complaint(folder.path), "cannot read the checkpoint '': it is a folder");
  ASSERT_EQ(mkfifo((folder.path / "pipe").c_str(), 0600), 0);  // which nobody writes into, and nobody waits for
  EXPECT_EQ(complaint(folder.path / "pipe"), "cannot read the checkpoint '': it is no regular file");
  put(folder.path / "large", "KERFCKPT");
  std::filesystem::resize_file(folder.path / "large", largest_input + 1);  // of holes
  EXPECT_EQ(complaint(folder.path / "large"),
            "cannot read the checkpoint '': it is too large; at most 4096 MiB are read");
  put(folder.path / "text", "[domain]\noutline = []\n");
  EXPECT_EQ(complaint(folder.path / "text"), "the checkpoint '' is no checkpoint of kerf; start without --resume");
  const auto fails = [](const std::filesystem::path& path) {
    try {
      write_checkpoint(path, sample());
    } catch (const Error& e) {
      EXPECT_EQ(e.fault, Fault::Files);
      return std::string(e.what()).find(path.string()) != std::string::npos;
    }
    return false;
  };
  EXPECT_TRUE(fails(folder.path / "absent" / "checkpoint.bin"));
  std::filesystem::create_directory(folder.path / "taken");
  EXPECT_TRUE(fails(folder.path / "taken"));
  EXPECT_FALSE(std::filesystem::exists(folder.path / "taken.part"));
}

TEST(Checkpoint, AKillLeavesTheOldOrTheNewOne) {
  const test::Folder folder;
  const auto path = folder.path / "checkpoint.bin";
  // Checkpoint k holds k everywhere: a mixture would show, even with a right checksum.
  const auto numbered = [](int k) {
    Checkpoint c;
    c.fingerprint = std::to_string(k);
    c.numbers["values"] = Eigen::VectorXd::Constant(2000 + k % 100, k);
    return c;
  };
  write_checkpoint(path, numbered(0));
  int last = 0;
  for (int round = 0; round < 25; ++round) {
    int written[2];
    ASSERT_EQ(pipe(written), 0);
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      for (int k = last + 1;; ++k) {
        write_checkpoint(path, numbered(k));
        if (write(written[1], "", 1) != 1) _exit(1);
      }
    }
    // Some checkpoints are whole, and the kill comes somewhere within another.
    char byte = 0;
    for (int k = 0; k < 1 + round % 4; ++k) ASSERT_EQ(read(written[0], &byte, 1), 1);
    usleep(static_cast<useconds_t>(97 * round));
    kill(child, SIGKILL);
    close(written[0]), close(written[1]);
    int status = 0;
    waitpid(child, &status, 0);
    ASSERT_TRUE(WIFSIGNALED(status));
    const auto found = read_checkpoint(path);
    ASSERT_TRUE(found);
    const int k = std::stoi(found->fingerprint);
    EXPECT_GT(k, last);
    expect_same(*found, numbered(k));
    last = k;
  }
}

}  // namespace
}  // namespace kerf::checkpoint_test

// The thread that writes files, against what a disk in memory has received: the order, the newest of what is written
// anew, failures, and how much may wait.

#include "app/write/writer.hpp"

#include "kerf/types.hpp"

#include <gtest/gtest.h>

#include <condition_variable>
#include <mutex>
#include <string>
#include <vector>

namespace kerf::writer_test {
namespace {

/// A disk that takes nothing until it is opened.
class Gate {
 public:
  void pass() {
    std::unique_lock lock(mutex_);
    opened_.wait(lock, [&] { return open_; });
  }
  void open() {
    {
      const std::scoped_lock lock(mutex_);
      open_ = true;
    }
    opened_.notify_all();
  }

 private:
  std::mutex mutex_;
  std::condition_variable opened_;
  bool open_ = false;
};

struct Disk {
  Gate gate;
  std::string written;
  Writing of(char c, std::string name = {}) {
    return {[this, c] {
              gate.pass();
              written += c;
            },
            1, std::move(name)};
  }
};

TEST(Writer, KeepsTheOrderAndDoesNotWait) {
  Disk disk;
  Writer writer;
  for (const char c : {'a', 'b', 'c'}) writer.put(disk.of(c));
  EXPECT_EQ(disk.written, "");
  disk.gate.open();
  writer.finish();
  EXPECT_EQ(disk.written, "abc");
}

TEST(Writer, WritesTheNewestOfWhatIsWrittenAnew) {
  Disk disk;
  Writer writer;
  writer.put(disk.of('0'));
  for (const char k : {'1', '2', '3'}) {
    writer.put(disk.of(k));
    writer.put(disk.of('h', "history"));
    writer.put_last(disk.of('c', "checkpoint"));
  }
  // Without its checkpoint a history takes no other's place: a checkpoint never knows more than the history does.
  writer.put(disk.of('4'));
  writer.put(disk.of('H', "history"));
  disk.gate.open();
  writer.finish();
  EXPECT_EQ(disk.written, "0123hc4H");
}

TEST(Writer, SaysWhatFailedAndWritesNothingAfterIt) {
  Disk disk;
  disk.gate.open();
  Writer writer;
  writer.put(disk.of('a'));
  writer.put({[] { throw Error(Fault::Files, "the disk is full"); }});
  const auto said = [&](const auto& call) {
    try {
      call();
    } catch (const Error& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_EQ(said([&] { writer.finish(); }), "the disk is full");
  EXPECT_EQ(said([&] { writer.put(disk.of('b')); }), "the disk is full");
  EXPECT_EQ(disk.written, "a");
}

TEST(Writer, BoundsWhatWaits) {
  Disk disk;
  disk.gate.open();
  Writer writer;
  std::string wanted;
  for (int k = 0; k < 500; ++k) {
    Writing one = disk.of(static_cast<char>('a' + k % 26));
    one.bytes = std::size_t{30} << 20;
    wanted += static_cast<char>('a' + k % 26);
    writer.put(std::move(one));
  }
  writer.finish();
  EXPECT_EQ(disk.written, wanted);
}

}  // namespace
}  // namespace kerf::writer_test

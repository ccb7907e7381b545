#pragma once
// Files are written while the run goes on: by one thread, in the order in which they were given to it.

#include <cstddef>
#include <functional>
#include <memory>
#include <string>

namespace kerf {

struct Writing {
  std::function<void()> write;  // with copies of what it needs
  std::size_t bytes = 0;        // that these take, about
  std::string name = {};        // of a file that is written anew and anew; empty: of one that is not
};

/// What `write` throws comes out of the next call, and nothing further is written then. No more than some bytes and
/// some files wait: who brings more waits until all of them are written.
class Writer {
 public:
  Writer();
  /// Writes what is there; an error then is nobody's.
  ~Writer();
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;

  void put(Writing writing);
  /// The last of what belongs together, as a checkpoint is of an iterate. What waits under a name that came again since
  /// is not written: a slow disk gets the newest only.
  void put_last(Writing writing);
  /// Until all is written.
  void finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace kerf

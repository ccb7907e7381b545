// Files written by a thread of their own while a run goes on, in the order in which they were put. At most 24 wait, or
// 64 MiB: who puts more waits until everything is written, so that what is put last gets its turn on a slow disk. What
// is written anew under one name replaces what waits under it (put_last). A failure is thrown to whoever puts next or
// finishes; what waited is dropped then. Where no thread can be had files are written at once.

#include "app/write/writer.hpp"

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <set>
#include <system_error>
#include <thread>
#include <utility>

namespace kerf {

namespace {

constexpr std::size_t most_waiting = 24, most_bytes = std::size_t{64} << 20;

}  // namespace

struct Writer::State {
  std::mutex mutex;
  std::condition_variable came, done;
  std::deque<Writing> waiting;
  std::size_t bytes = 0;  // of what waits
  bool busy = false, over = false;
  std::exception_ptr failure;
  std::thread thread;

  bool idle() const {
    return waiting.empty() && !busy;
  }
  void drop(std::deque<Writing>::iterator which) {
    bytes -= which->bytes;
    waiting.erase(which);
  }
  void work() {
    std::unique_lock lock(mutex);
    while (true) {
      came.wait(lock, [&] { return over || !waiting.empty(); });
      if (waiting.empty()) return;
      {
        const Writing next = std::move(waiting.front());
        waiting.pop_front();
        busy = true;
        lock.unlock();
        std::exception_ptr thrown;
        try {
          next.write();
        } catch (...) {
          thrown = std::current_exception();
        }
        lock.lock();
        bytes -= next.bytes;
        if (thrown) {
          failure = thrown;
          waiting.clear();
          bytes = 0;
        }
      }
      busy = false;
      if (idle()) done.notify_all();
    }
  }
  void rethrow() const {
    if (failure) std::rethrow_exception(failure);
  }
  void wait(std::unique_lock<std::mutex>& lock) {
    done.wait(lock, [&] { return idle(); });
    rethrow();
  }
  /// Whether there is a thread. It may not be had where memory or processes are short.
  bool start() {
    if (thread.joinable()) return true;
    try {
      thread = std::thread([this] { work(); });
    } catch (const std::system_error&) {
      return false;
    }
    return true;
  }
  /// Of those with one name that wait, the last one stays.
  void thin() {
    std::set<std::string> seen;
    for (std::size_t k = waiting.size(); k-- > 0;) {
      const auto one = waiting.begin() + static_cast<std::ptrdiff_t>(k);
      if (!one->name.empty() && !seen.insert(one->name).second) drop(one);
    }
  }
};

Writer::Writer() : state_(std::make_unique<State>()) {}

Writer::~Writer() {
  {
    const std::scoped_lock lock(state_->mutex);
    state_->over = true;
  }
  state_->came.notify_all();
  if (state_->thread.joinable()) state_->thread.join();
}

void Writer::put(Writing writing) {
  State& s = *state_;
  std::unique_lock lock(s.mutex);
  s.rethrow();
  if (!s.start()) return writing.write();
  // Until all is written, not until there is room: then what is put last gets its turn, however slow the disk is.
  if (!s.idle() && (s.waiting.size() >= most_waiting || s.bytes + writing.bytes > most_bytes)) s.wait(lock);
  const std::size_t bytes = writing.bytes;
  s.waiting.push_back(std::move(writing));
  s.bytes += bytes;
  s.came.notify_all();
}

void Writer::put_last(Writing writing) {
  put(std::move(writing));
  const std::scoped_lock lock(state_->mutex);
  state_->thin();
}

void Writer::finish() {
  std::unique_lock lock(state_->mutex);
  state_->wait(lock);
}

}  // namespace kerf

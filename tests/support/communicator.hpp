#pragma once
// Processes that are threads of one program.

#include "solver/divided_body.hpp"

#include <barrier>
#include <exception>
#include <functional>
#include <thread>

namespace kerf::test {

/// work(comm) on each of `count` processes at once. The first exception, by their numbers, is thrown again; a peer that
/// throws leaves the others alone, who must not wait for it: all throw, or none.
inline void on_peers(int count, const std::function<void(Communicator&)>& work) {
  struct Hub {
    explicit Hub(int n) : all(n), bytes(static_cast<std::size_t>(n)) {}
    std::barrier<> all;
    std::vector<std::vector<std::string>> bytes;  // from each to each
  } hub(count);
  class Thread : public Communicator {
   public:
    Thread(Hub& hub, int here, int count) : hub_(hub), here_(static_cast<std::size_t>(here)), count_(count) {}
    Index here() const override {
      return static_cast<Index>(here_);
    }
    Index count() const override {
      return count_;
    }
    void sum(std::span<double> values) override {
      combine(values, [](double a, double b) { return a + b; });
    }
    void largest(std::span<double> values) override {
      combine(values, [](double a, double b) { return std::max(a, b); });
    }
    std::vector<std::string> exchange(const std::vector<std::string>& to) override {
      hub_.bytes[here_] = to;
      hub_.all.arrive_and_wait();
      std::vector<std::string> from;
      for (const auto& sent : hub_.bytes) from.push_back(sent[here_]);
      hub_.all.arrive_and_wait();
      return from;
    }

   private:
    void combine(std::span<double> values, double (*both)(double, double)) {
      const std::vector<double> all = gathered(*this, std::vector<double>(values.begin(), values.end()));
      for (std::size_t i = 0; i < values.size(); ++i) {
        values[i] = all[i];
        for (std::size_t p = 1; p < hub_.bytes.size(); ++p) values[i] = both(values[i], all[p * values.size() + i]);
      }
    }
    Hub& hub_;
    std::size_t here_;
    Index count_;
  };
  std::vector<std::exception_ptr> failed(static_cast<std::size_t>(count));
  {
    std::vector<std::jthread> threads;
    for (int p = 0; p < count; ++p)
      threads.emplace_back([&, p] {
        Thread comm(hub, p, count);
        try {
          work(comm);
        } catch (...) {
          failed[static_cast<std::size_t>(p)] = std::current_exception();
        }
      });
  }
  for (const std::exception_ptr& f : failed)
    if (f) std::rethrow_exception(f);
}

}  // namespace kerf::test

// Starts of an optimization shared among processes: process p of n takes the tasks p, p + n, p + 2n, ... and the
// answers go to the first one, put back in the order of the tasks.

#include "app/parts/task_pool.hpp"

#include "app/parts/parts.hpp"
#include "base/packer.hpp"

namespace kerf {

namespace {

/// Every so-manieth task is that of a process; the answers of all go to the first one, in the order of the tasks.
std::vector<std::string> share(const Case& c, const std::vector<std::string>& tasks, Communicator& comm) {
  const auto here = static_cast<std::size_t>(comm.here()), count = static_cast<std::size_t>(comm.count());
  const Problem problem = problem_of(c, 1);
  Packer own;
  for (std::size_t i = here; i < tasks.size(); i += count) own.put(try_start(problem, *c.optimize, tasks[i]));
  std::vector<std::string> to(count);
  to[0] = std::move(own).take();
  const std::vector<std::string> from = comm.exchange(to);
  if (here > 0) return {};
  std::vector<std::string> answers(tasks.size());
  for (std::size_t p = 0; p < count; ++p) {
    Unpacker of(from[p]);
    for (std::size_t i = p; i < tasks.size(); i += count) answers[i] = of.text();
  }
  return answers;
}

constexpr char starts = 's';  // what a task of them begins with

}  // namespace

bool has_starts_to_share(const Case& c) {
  return c.optimize && c.optimize->method != OptimizeMethod::LevelSet && c.optimize->starts > 1 && !c.fit &&
         !c.synthetic;
}

TaskPool task_pool_of(const Case& c, Processes* processes) {
  if (!processes || processes->count() == 1 || !has_starts_to_share(c)) return {};
  return [&c, processes](const std::vector<std::string>& tasks) {
    Packer packed;
    packed(starts, tasks);
    std::vector<std::string> answers;
    processes->work(std::move(packed).take(), [&](Communicator& comm) { answers = share(c, tasks, comm); });
    return answers;
  };
}

void work_on(const Case& c, std::string_view task, Communicator& comm) {
  if (task.empty() || task.front() != starts) return work_on_part(c, task, comm);
  Unpacker from(task.substr(1));
  const auto tasks = from.all<std::string>();
  share(c, tasks, comm);
}

}  // namespace kerf

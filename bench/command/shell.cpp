// Commands of the shell with their output, exit code, memory and processor time; scripts in a copy of their folder.

#include "bench/command/shell.hpp"

#include "kerf/types.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdlib>

namespace kerf {

namespace fs = std::filesystem;

namespace {

std::string quoted_for_shell(const std::string& text) {  // for the shell
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? "'\\''" : std::string(1, c);
  return out + "'";
}

double seconds(const timeval& t) {
  return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
}

}  // namespace

bool in_path(const std::string& program) {
  const char* path = std::getenv("PATH");
  std::string folders = path ? path : "";
  for (std::size_t at = 0; at <= folders.size();) {
    const std::size_t end = std::min(folders.find(':', at), folders.size());
    if (access((fs::path(folders.substr(at, end - at)) / program).c_str(), X_OK) == 0) return true;
    at = end + 1;
  }
  return false;
}

Outcome shell(const std::string& command) {
  Outcome out;
  std::array<int, 2> ends;
  if (pipe(ends.data()) != 0) return out;
  const pid_t child = fork();
  if (child == 0) {
    dup2(ends[1], STDOUT_FILENO);
    close(ends[0]);
    close(ends[1]);
    execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
    _exit(127);
  }
  close(ends[1]);
  std::array<char, 4096> block;
  if (child > 0)  // signals restart these calls
    for (ssize_t n; (n = read(ends[0], block.data(), block.size())) > 0;)
      out.output.append(block.data(), static_cast<std::size_t>(n));
  close(ends[0]);
  int status = 0;
  rusage usage{};
  if (child > 0 && wait4(child, &status, 0, &usage) == child) out.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128;
  out.memory_mb = static_cast<double>(usage.ru_maxrss) / 1024;
  out.seconds = seconds(usage.ru_utime) + seconds(usage.ru_stime);
  return out;
}

Outcome run_script(const fs::path& folder, const std::string& command, double limit) {
  return shell(
      fmt::format("cd {} && OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 MKL_NUM_THREADS=1 "
                  "FF_LOADPATH='/usr/lib/freefem++;;' FF_INCLUDEPATH='/usr/include/freefem++/idp;;' "
                  "timeout -k 5 {:.0f} {} 2>&1",
                  quoted_for_shell(folder.string()), limit, command));
}

/// The scripts write beside themselves: they run in a copy, with the reference data unpacked.
void copy_scripts(const fs::path& from, const fs::path& to) {
  std::error_code failed;
  fs::create_directories(to, failed);
  for (const auto& entry : fs::directory_iterator(from)) {
    const std::string type = entry.path().extension().string();
    if (type == ".edp" || type == ".idp" || type == ".py" || type == ".txt")
      fs::copy_file(entry.path(), to / entry.path().filename(), fs::copy_options::overwrite_existing, failed);
  }
  if (failed)
    throw Error(Fault::Files, fmt::format("cannot copy the scripts to {}: {}", to.string(), failed.message()));
  if (!fs::exists(from / "data")) return;
  for (const auto& entry : fs::directory_iterator(from / "data"))
    if (entry.path().extension() == ".gz")
      shell(fmt::format("gzip -dc {} > {}", quoted_for_shell(entry.path().string()),
                        quoted_for_shell((to / entry.path().stem()).string())));
}

}  // namespace kerf

// What programs share: signals that ask for a stop, the command line as it was typed, refusing words.

#include "app/program.hpp"

#include "io/words.hpp"
#include "kerf/stop.hpp"
#include "kerf/types.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <csignal>
#include <cstdio>
#include <string_view>

namespace kerf {

namespace {

extern "C" void on_signal(int) {
  request_stop();
}

}  // namespace

void catch_signals() {
  struct sigaction action = {};
  action.sa_handler = on_signal;
  action.sa_flags = SA_RESETHAND | SA_RESTART;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  struct sigaction hangup = {};
  if (sigaction(SIGHUP, nullptr, &hangup) == 0 && hangup.sa_handler != SIG_IGN) sigaction(SIGHUP, &action, nullptr);
  action = {};
  action.sa_handler = SIG_IGN;
  sigaction(SIGXFSZ, &action, nullptr);
}

std::string command_line(int argc, const char* const* argv) {
  const auto plain = [](unsigned char c) {
    return std::isalnum(c) || std::string_view("_-./=:,+@%").find(static_cast<char>(c)) != std::string_view::npos;
  };
  std::string line = argc > 0 ? std::filesystem::path(argv[0]).filename().string() : "kerf";
  for (int k = 1; k < argc; ++k) {
    std::string word;
    for (const char c : std::string_view(argv[k]))
      word += c == '\'' ? "'\\''" : std::string(1, static_cast<unsigned char>(c) < 32 ? ' ' : c);
    line += !word.empty() && std::all_of(word.begin(), word.end(), plain) ? " " + word : " '" + word + "'";
  }
  return line;
}

void print(const std::string& text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0)
    throw Error(Fault::Files, "cannot write to standard output");
}

void refuse_arguments(std::string message, const std::string& command) {
  std::replace(message.begin(), message.end(), '\n', ' ');
  throw Error(Fault::Usage, fmt::format("{}; see kerf {}--help", message, command));
}

void require_known(const char* what, const std::string& name, std::span<const std::string> known) {
  if (std::find(known.begin(), known.end(), name) == known.end())
    throw Error(Fault::Usage, fmt::format("unknown {} {}; {}", what, quote(name), suggest(name, known)));
}

std::string log_level(const std::string& asked, bool quiet) {
  return !asked.empty() ? asked : quiet ? "warn" : "info";
}

void make_ready(const std::filesystem::path& folder, bool force, const std::string& result, FolderLock& lock) {
  const std::filesystem::path path = folder / result;
  if (std::filesystem::exists(folder) && !std::filesystem::is_directory(folder))
    throw Error(Fault::Files, fmt::format("{} is not a folder; choose another with --output", folder.string()));
  lock.take(folder);
  if (!std::filesystem::exists(std::filesystem::symlink_status(path))) return;
  if (!force)
    throw Error(Fault::Files, fmt::format("{} already holds results; use --force to overwrite", folder.string()));
  std::filesystem::remove(path);
}

}  // namespace kerf

// kerf watch: a loop that looks five times a second whether the case, or a file in its folder, was saved. What changed
// is read, checked and drawn as by kerf check. An editor that writes a new file and renames it leaves none for a
// moment: then the loop waits. The page needs no server: it asks the browser to load it again every second, and the
// address of the picture carries the number of the change, so that no browser shows an old one.

#include "app/command/watch.hpp"

#include "app/program.hpp"
#include "app/run.hpp"
#include "app/sweep/sweep_page.hpp"
#include "io/files.hpp"
#include "io/text.hpp"
#include "kerf/case_file.hpp"
#include "kerf/stop.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <thread>

namespace kerf {

namespace {

namespace fs = std::filesystem;

/// What a case may name.
bool may_be_named(const fs::path& file) {
  static constexpr std::array<std::string_view, 7> endings{".toml", ".msh", ".geo", ".step", ".stp", ".brep", ".csv"};
  return std::ranges::find(endings, file.extension().string()) != endings.end();
}

/// When the newest was saved of the case and of the files beside it that it may name.
std::optional<fs::file_time_type> saved(const fs::path& file) {
  std::error_code gone;
  const fs::file_time_type own = fs::last_write_time(file, gone);
  if (gone) return std::nullopt;
  fs::file_time_type newest = own;
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, gone)) {
    std::error_code failed;
    if (!may_be_named(entry.path()) || !entry.is_regular_file(failed) || failed) continue;
    if (const fs::file_time_type time = entry.last_write_time(failed); !failed) newest = std::max(newest, time);
  }
  return newest;
}

struct Checked {
  bool right = false;
  std::string words;
};

Checked check_once(const fs::path& file, std::span<const std::string> overrides, const fs::path& folder) {
  try {
    return {true, check(read_case(file, overrides), folder)};
  } catch (const Error& e) {
    return {false, fmt::format("{}\n", e.what())};
  }
}

std::string escaped_lines(const std::string& text) {
  std::string out;
  for (std::size_t from = 0; from < text.size();) {
    const std::size_t end = std::min(text.find('\n', from), text.size());
    out += escape_html(text.substr(from, end - from)) + '\n';
    from = end + 1;
  }
  return out;
}

void write_watched(const fs::path& folder, const fs::path& file, const Checked& checked, int number) {
  const std::string picture =
      checked.right && fs::exists(folder / "check.png")
          ? fmt::format("<figure><img src=\"check.png?{}\" alt=\"The body with its loads and supports\"></figure>\n",
                        number)
          : std::string();
  write_file(folder / "watch.html",
             plain_page(file.filename().string(),
                        fmt::format("<p{}>{}, change {}</p>\n{}<pre>{}</pre>\n", checked.right ? "" : " class=\"bad\"",
                                    checked.right ? "The case is right" : "The case is wrong", number, picture,
                                    escaped_lines(checked.words)),
                        "<meta http-equiv=\"refresh\" content=\"1\">\n"));
}

}  // namespace

void watch_case(const fs::path& file, std::span<const std::string> overrides, const fs::path& folder) {
  if (!fs::exists(file)) throw Error(Fault::Files, fmt::format("{} is not there", file.string()));
  print(
      fmt::format("watching {}; open {} in a browser; Ctrl-C ends\n", file.string(), (folder / "watch.html").string()));
  std::optional<fs::file_time_type> seen;
  for (int number = 0; !stop_requested();) {
    const auto now = saved(file);
    if (now && now != seen) {
      seen = now;
      const Checked checked = check_once(file, overrides, folder);
      write_watched(folder, file, checked, ++number);
      print(fmt::format("\n{}{}", checked.right ? "" : "wrong: ", checked.words));
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
  }
}

}  // namespace kerf

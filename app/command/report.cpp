// The page of a run, made from the files in its folder.

#include "app/command/report.hpp"

#include "io/files.hpp"
#include "io/read_result.hpp"
#include "kerf/types.hpp"
#include "plot/inspection.hpp"
#include "plot/page.hpp"

#include <fmt/core.h>

namespace kerf {

void require_result(const std::filesystem::path& folder) {
  if (std::filesystem::exists(folder / "result.json")) return;
  const bool sweep = std::filesystem::exists(folder / "sweep.csv");
  throw Error(Fault::Files,
              fmt::format("{} holds no result.json; give the folder of {}", folder.string(),
                          sweep ? "one of the runs of this sweep; the page of them all is sweep.html, and kerf sweep "
                                  "with --collect makes it again"
                                : "a run that has ended, such as out/cracked_plate"));
}

void write_report(const std::filesystem::path& folder) {
  require_result(folder);
  const Result result = read_result(folder);
  PageData data;
  if (std::filesystem::exists(folder / "report.bin")) data.arrays = read_arrays(folder / "report.bin");
  if (std::filesystem::exists(folder / "case.toml")) data.case_text = read_file(folder / "case.toml");
  write_page(folder / "report.html", result, data);
  if (!result.edge_cracks) return;
  const std::filesystem::path picture = folder / "edge_cracks.png";
  write_inspection(folder / "inspect.html", result, data.case_text,
                   std::filesystem::exists(picture) ? read_file(picture) : std::string());
}

}  // namespace kerf

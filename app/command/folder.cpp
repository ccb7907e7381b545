// Whose files are in the folder of a run, and what goes before a new one begins. Only files with names that a run gives
// are ever removed, and only where case.toml says in its first comment that kerf wrote it: otherwise the files are
// somebody else's, and the run is refused. Results are overwritten with --force; an optimization that has a checkpoint
// and has not ended asks for --resume or --force. With --resume everything is removed but what it goes on from.

#include "app/folder.hpp"

#include "app/run/checkpoints.hpp"
#include "kerf/types.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <string>
#include <vector>

namespace kerf {

namespace {

namespace fs = std::filesystem;

enum class Leaving { Everything, ForResume };  // ForResume: without what a resumed run goes on from

/// What a run would write or remove.
std::vector<fs::path> results_in(const fs::path& folder, Leaving which) {
  std::vector<fs::path> found;
  std::error_code failed;
  for (const auto& entry : fs::directory_iterator(folder, failed)) {
    const std::string name = entry.path().filename().string(), type = entry.path().extension().string();
    const bool numbered = (name.starts_with("crack_") && (type == ".csv" || type == ".vtp")) ||
                          ((name.starts_with("probe_") || name.starts_with("beta_")) && type == ".csv") ||
                          ((name.starts_with("state_") || name.starts_with("map_")) && type == ".vtu");
    const bool resumed = ((name.starts_with("design_") || name.starts_with("growth_")) && type == ".vtu") ||
                         name.starts_with("checkpoint.") || name == "optimize.pvd" || name == "history.csv";
    constexpr std::array known{"result.json",
                               "state.vtu",
                               "state.pvtu",
                               "map.vtu",
                               "map.pvtu",
                               "map.csv",
                               "validate.csv",
                               "mesh.png",
                               "measured.csv",
                               "von_mises.png",
                               "map.png",
                               "validate.png",
                               "report.html",
                               "report.bin",
                               "design.png",
                               "evolution.png",
                               "history.png",
                               "optimality.png",
                               "design.toml",
                               "design.svg",
                               "design.dxf",
                               "design.msh",
                               "design.step",
                               "case.toml",
                               "bounds.csv",
                               "bounds.vtp",
                               "steps.csv",
                               "growth.csv",
                               "growth.png",
                               "grown.toml",
                               "growth.pvd",
                               "edge_cracks.csv",
                               "edge_cracks.png",
                               "inspect.html",
                               "drawn_edge_cracks.csv",
                               "interior_cracks.csv"};
    if ((resumed && which == Leaving::Everything) || numbered || std::ranges::find(known, name) != known.end())
      found.push_back(entry.path());
  }
  if (failed) throw Error(Fault::Files, fmt::format("cannot read {}: {}", folder.string(), failed.message()));
  std::ranges::sort(found);
  return found;
}

/// Every run begins with a case.toml that says so in its first comment.
bool is_of_kerf(const fs::path& folder) {
  std::error_code none;
  if (!fs::is_regular_file(fs::symlink_status(folder / "case.toml", none))) return false;
  std::ifstream in(folder / "case.toml");
  for (std::string line; std::getline(in, line) && line.starts_with('#');)
    if (line.starts_with(fmt::format("# {}", head_of_results))) return true;
  return false;
}

std::string names_of(const std::vector<fs::path>& files) {
  constexpr std::size_t most = 4;
  std::string text;
  for (std::size_t i = 0; i < std::min(most, files.size()); ++i)
    text += (i == 0 ? "" : ", ") + files[i].filename().string();
  return files.size() > most ? fmt::format("{} and {} more", text, files.size() - most) : text;
}

/// The results of an earlier run. Throws where files of others have their names.
std::vector<fs::path> own_results(const fs::path& folder, Leaving which) {
  std::vector<fs::path> found = results_in(folder, Leaving::Everything);
  if (!found.empty() && !is_of_kerf(folder))
    throw Error(Fault::Files,
                fmt::format("{} holds {}: results would have {}, and no run of kerf wrote what is there; "
                            "choose another folder with --output",
                            folder.string(), names_of(found), found.size() > 1 ? "these names" : "that name"));
  return which == Leaving::Everything ? found : results_in(folder, which);
}

}  // namespace

void remove_earlier_results(const fs::path& folder, bool resume) {
  for (const fs::path& path : own_results(folder, resume ? Leaving::ForResume : Leaving::Everything)) {
    std::error_code failed;
    fs::remove(path, failed);
    if (failed) throw Error(Fault::Files, fmt::format("cannot remove {}: {}", path.string(), failed.message()));
  }
}

void claim_folder(const fs::path& folder, bool force, bool resume, FolderLock& lock) {
  std::error_code none;
  if (!fs::exists(folder, none)) return lock.take(folder);
  if (!fs::is_directory(folder, none))
    throw Error(Fault::Files, fmt::format("{} is not a folder; choose another with --output", folder.string()));
  lock.take(folder);
  std::vector<fs::path> found = own_results(folder, Leaving::Everything);
  const bool ended = fs::exists(folder / "result.json", none), going = has_checkpoint(folder);
  if (force || (resume && (going || !ended))) return;
  if (going && !ended)
    throw Error(Fault::Files, fmt::format("{} holds a run that has not ended; --resume goes on with it, "
                                          "--force begins anew",
                                          folder.string()));
  std::erase(found, folder / "case.toml");  // alone it is of a run that came to nothing
  if (!found.empty())
    throw Error(Fault::Files, fmt::format("{} already holds results; use --force to overwrite", folder.string()));
}

}  // namespace kerf

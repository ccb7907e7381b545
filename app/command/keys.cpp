// `kerf keys`: the table of keys in one of its forms.

#include "app/command/keys.hpp"

#include "io/files.hpp"
#include "io/words.hpp"
#include "kerf/types.hpp"

#include <fmt/format.h>

#include <filesystem>

namespace kerf {

namespace {

std::string made_anew(const std::filesystem::path& folder, const std::vector<CommandWords>& commands) {
  const std::filesystem::path pages = folder / "case-files", schema = folder / "kerf.schema.json",
                              completion = folder / "kerf.bash";
  std::error_code failed;
  const std::filesystem::directory_iterator found(pages, failed);
  if (failed) throw Error(Fault::Files, fmt::format("cannot read {}: {}", pages.string(), failed.message()));
  for (const auto& entry : found)
    if (entry.path().extension() == ".md") write_file(entry.path(), with_key_tables(read_file(entry.path())));
  write_file(schema, keys_as_schema());
  write_file(completion, keys_as_completion(commands));
  return fmt::format("wrote {}, {} and {}\n", pages.string(), schema.string(), completion.string());
}

}  // namespace

std::string keys(const KeysRequest& request, const std::vector<CommandWords>& commands) {
  if (!request.completion.empty() && request.completion != "bash")
    throw Error(Fault::Usage,
                fmt::format("there is no completion for {}; there is one for bash", quote(request.completion)));
  if (!request.folder.empty()) return made_anew(request.folder, commands);
  if (!request.completion.empty()) return keys_as_completion(commands);
  if (request.schema) return keys_as_schema();
  return request.markdown ? keys_as_markdown() : keys_as_text(request.name);
}

}  // namespace kerf

// Fontconfig is told of the font beside the program, unless the user has told it of others.

#include "plot/fonts.hpp"

#include "io/module.hpp"

#include <cstdlib>
#include <filesystem>
#include <system_error>

namespace kerf {

void offer_own_font() {
  if (std::getenv("FONTCONFIG_FILE") || std::getenv("FONTCONFIG_PATH")) return;
  const std::filesystem::path file = find_beside("fonts.conf");
  std::error_code failed;
  const std::filesystem::path whole = file.empty() ? file : std::filesystem::absolute(file, failed);
  if (!whole.empty() && !failed) setenv("FONTCONFIG_FILE", whole.c_str(), 1);
}

}  // namespace kerf

#pragma once
// Commented cases to begin from: `kerf init`.

#include <string>
#include <vector>

namespace kerf {

struct Template {
  std::string name, description, text;  // the text is a case file
};
const std::vector<Template>& templates();

}  // namespace kerf

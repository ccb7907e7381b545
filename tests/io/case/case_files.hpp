#pragma once
// Case files made up in a test.

#include "kerf/case_file.hpp"
#include "tests/support/folder.hpp"

#include <gtest/gtest.h>

#include <fstream>

namespace kerf {

/// A file in a folder of its own that goes away with the object.
struct TemporaryFolder : test::Folder {
  std::filesystem::path write(const std::string& name, const std::string& text) const {
    std::ofstream(path / name, std::ios::binary) << text;
    return path / name;
  }
};

inline const std::string square = R"([domain]
outline = [[0, 0], [2, 0], [2, 1], [0, 1]]
sides = ["bottom", "right", "top", "left"]
[material]
young = 10
poisson = 0.25
)";

inline Case read(const std::string& text, const std::vector<std::string>& overrides = {}) {
  const TemporaryFolder folder;
  return read_case(folder.write("a.toml", text), overrides);
}

/// The message without the folder: "a.toml:line:column: ...".
inline std::string error(const std::string& text, const std::vector<std::string>& overrides = {},
                         Fault fault = Fault::Usage) {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder.write("a.toml", text);
  try {
    read_case(path, overrides);
  } catch (const Error& e) {
    EXPECT_EQ(e.fault, fault);
    std::string message = e.what();
    const std::string prefix = folder.path.string() + "/";
    for (std::size_t at; (at = message.find(prefix)) != std::string::npos;) message.erase(at, prefix.size());
    return message;
  }
  return "no error";
}

}  // namespace kerf

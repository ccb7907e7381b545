// An input from a seed and a number: a case of the corpus, changed once or more times, in bounds of work; a command
// line; now and then options, overrides and bytes that are wrong. The same two numbers and the same corpus give the
// same input everywhere.

#include "tests/fuzz/input.hpp"

#include "io/case/keys.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <stdexcept>

namespace kerf::fuzz {

namespace fs = std::filesystem;

std::string bytes_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

namespace {

const std::vector<std::string> outputs = {"out", "out/deeper", "case.toml", "x y", "-", "\xc3\xa9", ""};

/// Options, well and badly written.
void odd_options(Dice& dice, std::vector<std::string>& arguments) {
  static const std::vector<std::string> options = {
      "--force",   "--quiet",         "--resume",         "--dry-run",   "--max-memory", "--max-seconds",
      "--help",    "--threads",       "--log-level",      "--format",    "--bogus",      "--set",
      "case.toml", "--max-seconds=0", "--max-memory=1MB", "--threads=3", "--set=",       "-x",
      "--"};
  static const std::vector<std::string> values = {"1", "0",   "-1",   "2",     "800MB",     "nan",
                                                  "",  "4.1", "info", "1e400", "mesh.size", "\xff"};
  arguments.push_back(dice.one_of(options));
  if (dice.chance(0.5)) arguments.push_back(dice.one_of(values));
}

/// --set KEY=VALUE of a key that there is, or nearly.
void override_key(Dice& dice, std::vector<std::string>& arguments) {
  const auto keys = all_keys();
  const std::string_view path = keys[dice.below(keys.size())].path;
  std::string words;
  for (const char c : path)
    if (c != '[' && c != ']') words += c;
  Value one{.kind = Value::Kind::Table};
  one.items.emplace_back(words, value_for(dice, path));
  std::string line = write_toml(one);  // "key" = value: quotes of the key are not wanted
  const std::size_t eq = line.find(" = ");
  line = eq == std::string::npos ? words + "=" : words + "=" + line.substr(eq + 3);
  while (!line.empty() && line.back() == '\n') line.pop_back();
  if (dice.chance(0.1)) damage(dice, line);
  line.erase(std::remove(line.begin(), line.end(), '\0'), line.end());
  arguments.insert(arguments.end(), {"--set", line});
}

std::vector<std::string> command_of(Dice& dice, Value& document) {
  static const std::vector<std::string> commands = {"check", "check", "check",    "solve",    "solve",
                                                    "solve", "solve", "map",      "map",      "run",
                                                    "run",   "run",   "validate", "optimize", "mesh"};
  std::string command = dice.one_of(commands);
  if ((command == "validate" || command == "optimize") && !member(document, command) && dice.chance(0.9))
    command = "run";
  if (command == "run" || command == "solve") {  // what the case is there for, more often than not
    if (member(document, "optimize") && dice.chance(0.2)) command = "optimize";
    if (member(document, "validate") && dice.chance(0.2)) command = "validate";
  }
  std::vector<std::string> out = {command, "case.toml"};
  out.insert(out.end(), {"-o", command == "mesh"   ? (dice.chance(0.5) ? "out.msh" : "out.vtu")
                               : dice.chance(0.02) ? dice.one_of(outputs)
                                                   : "out"});
  out.insert(out.end(), {"--threads", dice.chance(0.9) ? "1" : "2"});
  if (dice.chance(0.9)) out.insert(out.end(), {"--log-level", "off"});
  while (dice.chance(0.06)) override_key(dice, out);
  if (dice.chance(0.03)) odd_options(dice, out);
  return out;
}

}  // namespace

Corpus read_corpus(const std::vector<fs::path>& folders) {
  std::vector<fs::path> files;
  for (const fs::path& folder : folders)
    for (const auto& entry : fs::directory_iterator(folder))
      if (entry.path().extension() == ".toml") files.push_back(entry.path());
  std::sort(files.begin(), files.end(),
            [](const fs::path& a, const fs::path& b) { return a.filename() < b.filename(); });
  Corpus corpus;
  for (const fs::path& file : files) {
    Seed seed{.name = file.filename().string()};
    try {
      seed.document = read_toml(bytes_of(file));
    } catch (const std::exception&) {
      continue;
    }
    for (const Place& p : places(seed.document))
      if (const Value& v = p.value(); v.kind == Value::Kind::Text && v.text.find('.') != std::string::npos)
        if (const fs::path named = file.parent_path() / v.text; fs::is_regular_file(named))
          seed.files[v.text] = bytes_of(named);
    corpus.push_back(std::move(seed));
  }
  if (corpus.empty()) throw std::runtime_error("the corpus has no case file");
  return corpus;
}

Input make_input(const Corpus& corpus, std::uint64_t seed, std::uint64_t number) {
  Dice dice(seed, number);
  const Seed& start = dice.one_of(corpus);
  Input input{.arguments = {}, .files = start.files, .from = start.name};
  Value document = start.document;
  if (!dice.chance(0.02))  // else as it is
    do mutate(dice, document, corpus);
    while (dice.chance(0.35));
  tame(dice, document);
  input.arguments = command_of(dice, document);
  for (auto& [name, bytes] : input.files)
    if (dice.chance(0.7)) damage_lines(dice, bytes);
  std::string text = write_toml(document);
  if (dice.chance(0.04)) damage(dice, text);
  input.files["case.toml"] = std::move(text);
  return input;
}

}  // namespace kerf::fuzz

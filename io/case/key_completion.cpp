// The completion script for bash, with every key that --set can name.

#include "io/case/keys.hpp"
#include "io/keys.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace kerf {

namespace {

/// Every key that --set can name, with 0 for the number of an entry, tables that are like others written out.
void list_completions(const std::string& table, std::string_view above, std::vector<std::string>& out) {
  for (const Key* key : keys_in(table)) {
    std::string path = fmt::format("{}{}{}", table, table.empty() ? "" : ".", name(*key));
    if (key->path.ends_with("[]")) path += "[]";
    if (name(*key) == above) continue;  // a sum holds no sum
    if (key->type != KeyType::Table && key->type != KeyType::Tables && key->type != KeyType::Formulas)
      out.push_back(path.ends_with("[]") ? path.substr(0, path.size() - 2) : path);
    if (has(key->type, KeyType::Table) || has(key->type, KeyType::Tables)) list_completions(path, name(*key), out);
  }
}

constexpr std::string_view script =
    R"(# Completion of kerf for bash; `kerf keys --completion bash` prints it. Use: source kerf.bash

_kerf() {
  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} options=
  COMPREPLY=()
  if [ "$COMP_CWORD" -eq 1 ]; then
    COMPREPLY=($(compgen -W "@commands@ --help --version" -- "$word"))
    return
  fi
  case $before in
    --set)
      COMPREPLY=($(compgen -S = -W "$_kerf_keys" -- "$word"))
      compopt -o nospace
      return ;;
    -o | --output | --peers | --write) COMPREPLY=($(compgen -d -- "$word")) && return ;;
  esac
  case ${COMP_WORDS[1]} in
@cases@  esac
  if [[ $word == -* ]]; then
    COMPREPLY=($(compgen -W "$options" -- "$word"))
  elif [ "${COMP_WORDS[1]}" = keys ]; then
    COMPREPLY=($(compgen -W "$_kerf_keys" -- "$word"))
  else
    COMPREPLY=($(compgen -f -X '!*.toml' -- "$word") $(compgen -d -- "$word"))
  fi
}

_kerf_keys="
@keys@"

complete -F _kerf kerf
)";

void put(std::string& text, std::string_view mark, std::string_view what) {
  text.replace(text.find(mark), mark.size(), what);
}

}  // namespace

std::string keys_as_completion(const std::vector<CommandWords>& commands) {
  std::vector<std::string> names, keys;
  std::string cases, lines;
  for (const CommandWords& command : commands) {
    names.push_back(command.name);
    cases += fmt::format("    {}) options=\"{}\" ;;\n", command.name, fmt::join(command.options, " "));
  }
  list_completions("", "", keys);
  for (std::string& key : keys) {
    for (std::size_t at; (at = key.find("[]")) != std::string::npos;) key.replace(at, 2, "[0]");
    lines += key + "\n";
  }
  std::string out(script);
  put(out, "@commands@", fmt::format("{}", fmt::join(names, " ")));
  put(out, "@cases@", cases);
  put(out, "@keys@", lines);
  return out;
}

}  // namespace kerf

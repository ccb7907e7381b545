// The promises of the program for every input, checked one after another: exit codes 0 and 2 to 5, one message in words
// of the user, files in the folder of the run alone, a result.json that agrees with the exit code, no NaN in what it
// says. The first promise that is broken names the fault.

#include "tests/fuzz/contract.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

namespace kerf::fuzz {

namespace {

using Json = nlohmann::json;
using Found = std::optional<Failure>;

bool contains(std::string_view text, std::string_view words) {
  return text.find(words) != std::string_view::npos;
}

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

std::string one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', '|');
  if (text.size() > 400) text.resize(400);
  return text;
}

/// As a word of its own.
bool says(const std::string& text, std::string_view word) {
  for (std::size_t at = 0; (at = text.find(word, at)) != std::string::npos; ++at) {
    const auto letter = [&](std::size_t i) {
      return i < text.size() && (std::isalnum(static_cast<unsigned char>(text[i])) || text[i] == '_');
    };
    if ((at == 0 || !letter(at - 1)) && !letter(at + word.size())) return true;
  }
  return false;
}

/// What was given, in small letters: words of it may come back in messages.
std::string given(const Input& input) {
  std::string all;
  for (const std::string& a : input.arguments) all += a + ' ';
  for (const auto& [name, bytes] : input.files) all += name + ' ' + bytes;
  return lower(all);
}

Found ending(const Outcome& o) {
  if (o.hung) return Failure{"hang", fmt::format("killed after {:.0f} s: it did not stop when asked to", o.seconds)};
  if (o.signal != 0 && !(o.asked && o.signal == 15))
    return Failure{fmt::format("signal {}", o.signal), fmt::format("{}; {}", strsignal(o.signal), one_line(o.error))};
  if (o.signal == 0 && o.code != 0 && (o.code < 2 || o.code > 5))
    return Failure{fmt::format("exit {}", o.code), one_line(o.error)};
  return {};
}

/// One message, the last line, in words of the user.
Found message(const Input& input, const Outcome& o) {
  if (o.code <= 0) return {};
  std::vector<std::string> said;
  std::size_t at = 0;
  const bool quiet = std::find(input.arguments.begin(), input.arguments.end(), "off") != input.arguments.end();
  for (std::size_t end; at < o.error.size(); at = end + 1) {
    end = std::min(o.error.find('\n', at), o.error.size());
    std::string line = o.error.substr(at, end - at);
    if (!quiet && line.starts_with("[") && contains(line, "] [")) continue;  // the log
    said.push_back(line);
  }
  // Of a case file all that is wrong is said, a line each.
  const auto further = [](const std::string& line) {
    return line.starts_with("case.toml:") || line.starts_with("--set ");
  };
  if (said.empty() || !said[0].starts_with("kerf: ") || !std::all_of(said.begin() + 1, said.end(), further))
    return Failure{fmt::format("{} lines on stderr, exit {}", said.size(), o.code), one_line(o.error)};
  const std::string words = lower(said[0]), from = given(input);
  static const std::array<const char*, 14> internal = {
      "unexpected failure", "std::", "bad_alloc", "basic_string", "vector::",
      "invalid_argument",   "__",    "assert",    "terminate",
      "cholmod_",  // as backends they have names for users
      "umfpack_",           "0x",    "eigen::",   "c++"};
  for (const char* word : internal)
    if (contains(words, word) && !contains(from, word))
      return Failure{fmt::format("internal words: {}", word), one_line(said[0])};
  for (const char* word : {"nan", "inf", "-nan"})
    if (says(words, word) && !contains(words, "not finite") && !contains(from, word) && !contains(from, "e3") &&
        !contains(from, "1e"))
      return Failure{fmt::format("{} in the message", word), one_line(said[0])};
  if (said[0].size() < 16) return Failure{"a message that says nothing", one_line(said[0])};
  if (o.code == 2 && contains(words, "case.toml:") &&
      !std::isdigit(static_cast<unsigned char>(words[words.find("case.toml:") + 10])))
    return Failure{"no line of the case file", one_line(said[0])};
  return {};
}

/// What lies where.
Found places_of_files(const Input& input, const Outcome& o) {
  if (!o.elsewhere.empty()) return Failure{"files elsewhere", o.elsewhere[0]};
  const auto option = std::find(input.arguments.begin(), input.arguments.end(), "-o");
  const std::string folder = option == input.arguments.end() || option + 1 == input.arguments.end() ? "out" : option[1];
  const bool ended = o.signal == 0;
  for (const auto& [name, bytes] : o.files) {
    if (name != folder && !name.starts_with(folder + "/") && !name.starts_with("out/"))
      return Failure{"writes outside its folder", name};
    if (ended && name.ends_with(".part")) return Failure{"leaves *.part", name};
    if (name.ends_with(".csv") && (says(lower(bytes), "nan") || says(lower(bytes), "inf")))
      return Failure{"nan in a table", name};
  }
  return {};
}

bool finite(const Json& section, const char* name) {
  return section.contains(name) && section[name].is_number() && std::isfinite(section[name].get<double>());
}

double number(const Json& section, const char* name) {
  return finite(section, name) ? section[name].get<double>() : std::nan("");
}

template <std::size_t n>
bool known(const std::string& word, const std::array<const char*, n>& words) {
  return std::any_of(words.begin(), words.end(), [&](const char* w) { return word == w; });
}

Found state_of(const Json& state, bool ok) {
  if (!ok) return {};
  for (const char* name : {"energy", "compliance", "area", "residual"})
    if (!finite(state, name))
      return Failure{fmt::format("{} is no number", name),
                     fmt::format("state.{} = {} with status ok", name, state.value(name, Json()).dump())};
  const bool noted = state.contains("notes") && !state["notes"].empty();
  if (number(state, "residual") > 1e-8 && !noted)
    return Failure{"residual without a note", fmt::format("residual {:.3g}", number(state, "residual"))};
  if (number(state, "work_error") > 1e-8 && !noted)
    return Failure{"work without a note", fmt::format("work_error {:.3g}", number(state, "work_error"))};
  const Json bounds = state.value("energy_bounds", Json());
  if (bounds.is_array() && bounds[0].is_number() && bounds[1].is_number()) {
    const double low = bounds[0], high = bounds[1];
    if (low > high) return Failure{"bounds cross", bounds.dump()};
  }
  return {};
}

Found verdicts(const Json& r) {
  static constexpr std::array<const char*, 5> validations = {"holds", "fails", "vanishes", "out of range",
                                                             "nothing can be said"};
  for (const Json& v : r.value("validate", Json::array())) {
    if (!known(v.value("verdict", ""), validations)) return Failure{"unknown verdict", v.value("verdict", "")};
    const std::string reason = lower(v.value("reason", ""));
    if (says(reason, "nan") || says(reason, "inf")) return Failure{"nan in a verdict", reason};
  }
  if (r.contains("optimize")) {
    static constexpr std::array<const char*, 6> endings = {"optimal",
                                                           "stalled",
                                                           "budget used",
                                                           "infeasible",
                                                           "the model does not explain the readings",
                                                           "not enough readings"};
    const Json& o = r["optimize"];
    const std::string ending = o.value("ending", "");
    if (!known(ending, endings) && !ending.starts_with("optimal within "))
      return Failure{"unknown ending", o.value("ending", "")};
    if (r["status"] == "ok" && !finite(o, "objective"))
      return Failure{"objective is no number", o.value("stopped", "")};
  }
  if (r.value("status", "") == "ok" && r.contains("functional") && !finite(r["functional"], "value"))
    return Failure{"functional is no number", r["functional"].dump()};
  return {};
}

Found result_of(const Input& input, const Outcome& o) {
  static constexpr std::array<const char*, 4> states = {"ok", "not converged", "failed", "infeasible"};
  const std::string command = input.arguments.empty() ? "" : input.arguments[0];
  const bool solves = known(command, std::array<const char*, 5>{"run", "solve", "map", "validate", "optimize"});
  bool found = false;
  for (const auto& [name, bytes] : o.files) {
    if (!name.ends_with("result.json")) continue;
    found = true;
    if (o.signal != 0) continue;
    const Json r = Json::parse(bytes, nullptr, false);
    if (r.is_discarded() || !r.is_object()) return Failure{"result.json is no JSON", one_line(bytes)};
    const std::string status = r.value("status", "");
    if (!known(status, states)) return Failure{"unknown status", status};
    if ((status == "ok") != (o.code == 0))
      return Failure{"status and exit code", fmt::format("{} with exit {}", status, o.code)};
    if (r.contains("state"))
      if (Found f = state_of(r["state"], status == "ok")) return f;
    if (Found f = verdicts(r)) return f;
  }
  const auto has = [&](const char* option) {
    return std::find(input.arguments.begin(), input.arguments.end(), option) != input.arguments.end();
  };
  if (solves && o.code == 0 && !found && !has("--dry-run") && !has("--help"))
    return Failure{"exit 0 without result.json", ""};
  return {};
}

Found summary_of(const Input& input, const Outcome& o) {
  const std::string out = lower(o.out), from = given(input);
  for (const char* word : {"nan", "-nan"})
    if (says(out, word) && !contains(from, "nan")) {
      const std::size_t at = out.find(word), begin = out.rfind('\n', at) + 1;
      return Failure{"nan in the summary", one_line(o.out.substr(begin, o.out.find('\n', at) - begin))};
    }
  return {};
}

}  // namespace

std::optional<Failure> broken(const Input& input, const Outcome& o) {
  if (Found f = ending(o)) return f;
  if (Found f = message(input, o)) return f;
  if (Found f = places_of_files(input, o)) return f;
  if (Found f = result_of(input, o)) return f;
  return summary_of(input, o);
}

}  // namespace kerf::fuzz

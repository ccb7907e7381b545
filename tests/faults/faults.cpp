// A run under faults of its own: what it left is compared with a run without faults. Either it ends with exit code 4 or
// 5 and a message, or with 0 and the same numbers and files; an optimization and margins that found no memory are the
// exceptions.

#include "tests/faults/faults.hpp"

#include <algorithm>
#include <cstdlib>

namespace kerf::fuzz {

namespace fs = std::filesystem;

Input Faults::input(const std::string& command, const std::string& text, const std::vector<std::string>& more) {
  Input input{.arguments = {command, "case.toml", "-o", "out", "--threads", "1", "--log-level", "off"},
              .files = {{"case.toml", text}}};
  input.arguments.insert(input.arguments.end(), more.begin(), more.end());
  return input;
}

Outcome Faults::run(const Input& input, const Limits& limits) const {
  return run_child(KERF_PROGRAM, input, limits, folder / "run");
}

std::string small_case_with_files() {
  return R"(title = "small"
[domain]
outline = [[0, 0], [2, 0], [2, 0.45], [2, 0.55], [2, 1], [0, 1]]
sides = ["bottom", "right", "load", "right", "top", "left"]
[[crack]]
name = "c"
path = [[0.5, 0.3], [0.8, 0.4]]
[material]
young = 1
poisson = 0.3
state = "plane stress"
[[boundary]]
on = "left"
displacement = [0, 0]
[[boundary]]
on = "load"
traction = [0, -0.001]
[mesh]
size = 0.3
crack_tip_size = 0.1
[functional]
kind = "compliance"
[map]
perturbation = "hole"
[validate]
points = [[1.2, 0.5]]
radii = { largest = 0.1, ratio = 0.5, count = 3 }
[optimize]
volume = { at_most = 0.8 }
max_iterations = 3
[[probe]]
name = "p"
points = [[0.2, 0.2]]
)";
}

std::string small_case() {
  return small_case_with_files() + "[output]\nvtk = false\npng = false\nhtml = false\n";
}

nlohmann::json numbers_of(const Outcome& outcome) {
  const auto found = outcome.files.find("out/result.json");
  if (found == outcome.files.end()) return nullptr;
  nlohmann::json r = nlohmann::json::parse(found->second, nullptr, false);
  if (r.is_discarded() || !r.is_object()) return nullptr;
  r.erase("time_s");
  r.erase("peak_memory_mb");
  return r;
}

namespace {

const std::string no_margins = "no margins: one degree more needs more memory than there is";

bool is_the_note(const nlohmann::json& value) {
  return value.is_string() && value.get_ref<const std::string&>() == no_margins;
}

/// Does one of its notes say that the margins found no memory?
bool without_margins(const nlohmann::json& value) {
  return is_the_note(value) || (value.is_structured() && std::ranges::any_of(value, without_margins));
}

/// Every "margin", every note about margins.
void erase_margins(nlohmann::json& value) {
  const auto about_margins = [](const nlohmann::json& note) {
    return is_the_note(note) ||
           (note.is_string() && note.get_ref<const std::string&>().find(" is known to ") != std::string::npos);
  };
  if (value.is_object()) value.erase("margin");
  if (value.is_array()) std::erase_if(value.get_ref<nlohmann::json::array_t&>(), about_margins);
  if (value.is_structured())
    for (nlohmann::json& part : value) erase_margins(part);
}

}  // namespace

std::string unclean(const Input& input, const Outcome& outcome, const Outcome& whole) {
  // Libraries (METIS, OpenMP, VTK) say on stderr what they did not get: the program has the last word.
  Outcome last = outcome;
  const std::size_t end = last.error.rfind('\n', last.error.size() > 1 ? last.error.size() - 2 : 0);
  if (end != std::string::npos && end + 1 < last.error.size()) last.error.erase(0, end + 1);
  if (const auto failure = broken(input, last)) return failure->kind + ": " + failure->detail;
  if (outcome.code != 0) {
    if (outcome.code == 4 || outcome.code == 5) return "";
    return "exit " + std::to_string(outcome.code) + ": " + outcome.error;
  }
  // A step of an optimization that found no memory is tried again, shorter: another design, of which the same is said.
  nlohmann::json a = numbers_of(outcome), b = numbers_of(whole);
  for (nlohmann::json* r : {&a, &b})
    if (r->is_object()) r->erase("optimize");
  // Margins that found no memory are left out, and a note says so; all else is the same.
  if (a.is_object() && without_margins(a))
    for (nlohmann::json* r : {&a, &b}) erase_margins(*r);
  if (a != b) return "exit 0 with another result";
  for (const auto& [name, bytes] : whole.files)
    if (!outcome.files.contains(name)) return "exit 0 without " + name;
  return "";
}

}  // namespace kerf::fuzz

// The state of a descent in a checkpoint, bit for bit: vectors by name, scalars as one vector in a fixed order, texts
// by line. `check_state` refuses a state that no descent of this canvas keeps (sizes of the functions and bounds,
// ranges of radius, turn, weights and faith, rows in order, a next step that has what it needs), so that a damaged file
// ends as such and not in a wrong design. A new member of DescentState is added to `scalars` or `vectors` here, and to
// check_state.

#include "optimize/level_set/progress.hpp"

#include "optimize/checkpoint_reader.hpp"
#include "optimize/loop/history_text.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace kerf {

namespace {

// Vectors by name; the scalars are the entries of one vector, in this order: whole numbers are counts.
constexpr std::array<std::pair<const char*, Eigen::VectorXd DescentState::*>, 4> vectors{
    {{"phi", &DescentState::phi},
     {"psi", &DescentState::psi},
     {"weight", &DescentState::weight},
     {"faith", &DescentState::faith}}};
constexpr double least_faith = 0.1;
constexpr std::array<std::pair<const char*, KeptDesign DescentState::*>, 2> designs{
    {{"best", &DescentState::best}, {"anchor", &DescentState::anchor}}};

// The order is that of the file.
template <typename State>
auto scalars(State& s) {
  return std::tie(s.iteration, s.solves, s.allowed, s.radius, s.turn, s.price, s.since, s.trials, s.settled, s.next,
                  s.explore, s.residual, s.spent);
}
template <typename Design>
auto scalars_of(Design& d) {
  return std::tie(d.J, d.area, d.iteration);
}

Eigen::VectorXd vector_of_tuple(const auto& tuple) {
  return std::apply(
      [](const auto&... x) {
        Eigen::VectorXd v(static_cast<Eigen::Index>(sizeof...(x)));
        Eigen::Index i = 0;
        ((v[i++] = static_cast<double>(x)), ...);
        return v;
      },
      tuple);
}
void read(NumberReader& in, double& x) {
  x = in.any();
}
void read(NumberReader& in, int& x) {
  x = in.count();
}
void read(NumberReader& in, bool& x) {
  x = in.flag();
}
void read(NumberReader& in, const auto& tuple) {
  std::apply([&](auto&... x) { (read(in, x), ...); }, tuple);
}
void read_all(const Eigen::VectorXd& v, const auto& tuple) {
  NumberReader in(v);
  read(in, tuple);
  in.end();
}

bool within(double x, double least, double most) {
  return x >= least && x <= most;
}
/// None, or a function on the vertices that some norm can be told of.
bool is_function(const Eigen::VectorXd& phi, Eigen::Index vertices) {
  if (phi.size() == 0) return true;
  const double squares = phi.squaredNorm();
  return phi.size() == vertices && std::isfinite(squares) && squares > 0;
}

template <typename Hole>
auto scalars_of_hole(Hole& h) {
  return std::tie(h.iteration, h.at.x(), h.at.y(), h.radius, h.T, h.c2, h.predicted, h.actual);
}

void write_holes(Checkpoint& c, const std::vector<NucleatedHole>& holes) {
  std::vector<double> all;
  for (const NucleatedHole& h : holes) {
    const Eigen::VectorXd v = vector_of_tuple(scalars_of_hole(h));
    all.insert(all.end(), v.begin(), v.end());
    append_line(c.texts["nucleated"], h.note);
  }
  c.numbers["nucleated"] = Eigen::Map<const Eigen::VectorXd>(all.data(), static_cast<Eigen::Index>(all.size()));
}

// Places are finite; T, c2 and what was made may be unknown.
std::vector<NucleatedHole> read_holes(const Checkpoint& c) {
  NumberReader in(numbers_of(c, "nucleated"));
  LineReader notes(in.empty() && !c.texts.contains("nucleated") ? "" : std::string_view(text_of(c, "nucleated")));
  std::vector<NucleatedHole> holes;
  while (!in.empty()) {
    NucleatedHole& h = holes.emplace_back();
    read(in, scalars_of_hole(h));
    if (!h.at.allFinite()) throw broken_checkpoint();
    h.note = notes.line();
  }
  notes.end();
  return holes;
}

}  // namespace

// Designs as functions, bounds and scalars; what they look like is drawn and solved again.
Checkpoint packed(const DescentState& s) {
  Checkpoint c;
  for (const auto& [name, member] : vectors) c.numbers[name] = s.*member;
  for (const auto& [key, member] : designs) {
    const KeptDesign& d = s.*member;
    const std::string name = key;
    c.numbers[name] = d.phi;
    c.numbers[name + "_bounds"] = d.bounds;
    c.numbers[name + "_scalars"] = vector_of_tuple(scalars_of(d));
  }
  c.numbers["track"] = Eigen::Map<const Eigen::VectorXd>(s.track.data(), static_cast<Eigen::Index>(s.track.size()));
  c.numbers["scalars"] = vector_of_tuple(scalars(s));
  c.texts["ended"] = s.ended;
  c.texts["why"] = s.why;
  c.texts["drawn"] = join(s.drawn, "\n");
  write_rows(c, s.rows);
  write_holes(c, s.nucleated);
  return c;
}

DescentState unpacked(const Checkpoint& c) {
  DescentState s;
  for (const auto& [name, member] : vectors) s.*member = numbers_of(c, name);
  for (const auto& [key, member] : designs) {
    KeptDesign& d = s.*member;
    const std::string name = key;
    d.phi = numbers_of(c, name);
    d.bounds = numbers_of(c, name + "_bounds");
    read_all(numbers_of(c, name + "_scalars"), scalars_of(d));
  }
  const Eigen::VectorXd& track = numbers_of(c, "track");
  s.track.assign(track.begin(), track.end());
  read_all(numbers_of(c, "scalars"), scalars(s));
  s.ended = text_of(c, "ended");
  s.why = text_of(c, "why");
  s.drawn = split_lines(text_of(c, "drawn"));
  s.rows = read_rows(c);
  s.nucleated = read_holes(c);
  return s;
}

// Every number that the next step divides by, indexes with or takes a root of is looked at.
void check_state(const DescentState& s, const StateSizes& of) {
  const auto kept = [&](const KeptDesign& d) {
    const bool none = d.phi.size() == 0;
    return is_function(d.phi, of.vertices) && d.iteration <= s.iteration && !std::isnan(d.J) &&
           d.bounds.size() == (none ? 0 : of.bounds) && (none || (std::isfinite(d.J) && d.bounds.allFinite()));
  };
  const bool best = s.best.phi.size() > 0, anchor = s.anchor.phi.size() > 0;
  const bool functions = s.phi.size() > 0 && is_function(s.phi, of.vertices) && is_function(s.psi, of.vertices) &&
                         kept(s.best) && kept(s.anchor) && (best || !anchor);
  const bool bounds = s.weight.size() == of.bounds && s.faith.size() == of.bounds && s.weight.allFinite() &&
                      (s.weight.array() >= 0).all() && (s.faith.array() >= least_faith).all() &&
                      (s.faith.array() <= 1).all();
  const auto follows = [](const Iteration& a, const Iteration& b) { return a.number >= b.number; };
  const bool rows = std::ranges::any_of(s.rows, &Iteration::accepted) && s.rows.back().number <= s.iteration &&
                    std::ranges::adjacent_find(s.rows, follows) == s.rows.end() &&
                    std::ranges::all_of(s.rows, [&](const Iteration& r) {
                      return static_cast<Eigen::Index>(r.bounds.size()) == of.bounds && r.variables.size() == 0;
                    });
  const bool next = s.next <= static_cast<int>(Next::Nucleate) &&
                    (s.next != static_cast<int>(Next::CloseTrial) || anchor) &&
                    (s.next != static_cast<int>(Next::BackToBest) || best);
  const bool holes =
      std::ranges::all_of(s.nucleated, [&](const NucleatedHole& h) { return h.iteration <= s.iteration; });
  const bool lengths = s.allowed > 0 && within(s.radius, 0, of.radius) && within(s.turn, 0, of.turn) && s.radius > 0 &&
                       s.turn > 0 && std::isfinite(s.price);
  if (!(functions && bounds && rows && next && holes && lengths)) throw broken_checkpoint();
}

}  // namespace kerf

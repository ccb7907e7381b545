#include "optimize/level_set/progress.hpp"

#include "optimize/loop/history_text.hpp"

#include <tuple>

namespace kerf {

namespace {

// Vectors by name; the scalars are the entries of one vector, in this order.
constexpr std::array<std::pair<const char*, Eigen::VectorXd DescentState::*>, 4> vectors{
    {{"phi", &DescentState::phi},
     {"psi", &DescentState::psi},
     {"weight", &DescentState::weight},
     {"faith", &DescentState::faith}}};
constexpr std::array<std::pair<const char*, KeptDesign DescentState::*>, 2> designs{
    {{"best", &DescentState::best}, {"anchor", &DescentState::anchor}}};

template <typename State>
auto scalars(State& s) {
  return std::tie(s.iteration, s.solves, s.allowed, s.radius, s.turn, s.price, s.since, s.trials, s.settled, s.next,
                  s.explore, s.residual);
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
void read(const Eigen::VectorXd& v, const auto& tuple) {
  Eigen::Index i = 0;
  std::apply([&](auto&... x) { ((x = static_cast<std::remove_reference_t<decltype(x)>>(v[i++])), ...); }, tuple);
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
    c.texts["nucleated"] += h.note + '\n';
  }
  c.numbers["nucleated"] = Eigen::Map<const Eigen::VectorXd>(all.data(), static_cast<Eigen::Index>(all.size()));
}

std::vector<NucleatedHole> read_holes(const Checkpoint& c) {
  if (!c.texts.contains("nucleated")) return {};
  std::vector<NucleatedHole> holes;
  const Eigen::VectorXd& all = c.numbers.at("nucleated");
  for (std::string& note : split_lines(c.texts.at("nucleated"))) {
    const auto row = static_cast<Eigen::Index>(holes.size());
    NucleatedHole& h = holes.emplace_back();
    read(all.segment(8 * row, 8), scalars_of_hole(h));
    h.note = std::move(note);
  }
  return holes;
}

}  // namespace

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
  for (const auto& [name, member] : vectors) s.*member = c.numbers.at(name);
  for (const auto& [key, member] : designs) {
    KeptDesign& d = s.*member;
    const std::string name = key;
    d.phi = c.numbers.at(name);
    d.bounds = c.numbers.at(name + "_bounds");
    read(c.numbers.at(name + "_scalars"), scalars_of(d));
  }
  const Eigen::VectorXd& track = c.numbers.at("track");
  s.track.assign(track.begin(), track.end());
  read(c.numbers.at("scalars"), scalars(s));
  s.ended = c.texts.at("ended");
  s.why = c.texts.at("why");
  s.drawn = split_lines(c.texts.at("drawn"));
  s.rows = read_rows(c);
  s.nucleated = read_holes(c);
  return s;
}

}  // namespace kerf

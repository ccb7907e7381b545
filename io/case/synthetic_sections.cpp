#include "io/case/sections.hpp"
#include "kerf/element.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace kerf {

namespace {

/// Another element than that of the search.
void read_element(const Value& table, const Case& c, Synthetic& s) {
  const auto name = find(table, "element"), degree = find(table, "degree");
  s.element = c.element == "afw" ? "bdms" : "afw";
  s.degree = 2;
  if (name)
    s.element = choice(*name, {"peers", "bdms", "bdms-c", "afw", "arnold-winther", "arnold-winther-c",
                               "arnold-winther-nc", "p1", "p2"});
  if (name) s.degree = 1;
  if (degree) s.degree = whole_number(*degree, 1, 9);
  const Value& blamed = name ? *name : degree ? *degree : table;
  try {
    element(s.element, s.degree);
  } catch (const Error& e) {
    fail(blamed.node->position, e.what());
  }
  if (s.element == c.element && s.degree == c.degree)
    fail(blamed.node->position,
         fmt::format("{}: the data would be made with the element \"{}\" of degree {} that looks for the answer: an "
                     "inverse crime; choose another element or degree",
                     blamed.name, s.element, s.degree));
  const bool contact = std::any_of(s.true_scene.laws.begin(), s.true_scene.laws.end(),
                                   [](const CrackLaw& law) { return law.kind == CrackLaw::Kind::Unilateral; });
  const auto why = refusal(element(s.element, s.degree), can_contact);
  if (contact && why) fail(blamed.node->position, fmt::format("{}: {}", blamed.name, *why));
}

}  // namespace

void read_synthetic(const Value& document, Case& c) {
  const auto table = find_table(document, "synthetic");
  const auto measured = synthetic_misfit(document);
  if (!table) {
    if (measured)
      fail(measured->node->position, fmt::format("{} = \"synthetic\" needs the table [synthetic] with the true body; "
                                                 "add [[synthetic.hole]], [[synthetic.crack]] or [[synthetic.region]]",
                                                 measured->name));
    return;
  }
  allow_only(*table,
             {"hole", "crack", "region", "element", "degree", "size", "crack_tip_size", "noise", "spacing", "seed"});
  if (!measured)
    fail(table->node->position,
         "[synthetic] is not used; write kind = \"misfit\" and measured = \"synthetic\" in [functional]");

  Synthetic s;
  s.true_shape = c.shape;
  s.true_scene = c.scene;
  const std::vector<Value> holes = find_tables(*table, "hole"), cracks = find_tables(*table, "crack"),
                           regions = find_tables(*table, "region");
  if (holes.empty() && cracks.empty() && regions.empty())
    fail(table->node->position,
         "[synthetic]: there is nothing to be found; add [[synthetic.hole]], [[synthetic.crack]] or "
         "[[synthetic.region]]");
  add_holes(holes, s.true_shape);
  add_cracks(cracks, s.true_shape, s.true_scene.laws);
  add_regions(regions, c.plane_strain, s.true_shape, s.true_scene.regions);
  read_element(*table, c, s);

  s.sizing = c.sizing;
  constexpr double finer = 0.7;
  s.sizing.size = finer * (c.sizing.size > 0 ? c.sizing.size : extent(c.shape) / 40);
  s.sizing.crack_tip_size = finer * c.sizing.crack_tip_size;  // 0 stays: it follows from the size
  if (const auto size = find(*table, "size")) s.sizing.size = positive(*size);
  if (const auto size = find(*table, "crack_tip_size")) s.sizing.crack_tip_size = positive(*size);
  if (const auto noise = find(*table, "noise")) s.noise = between(*noise, 0, 1);
  s.spacing = c.sizing.size > 0 ? c.sizing.size : extent(c.shape) / 40;
  if (const auto spacing = find(*table, "spacing")) s.spacing = positive(*spacing);
  if (const auto seed = find(*table, "seed")) s.seed = static_cast<unsigned>(whole_number(*seed, 0, 2147483647));
  for (const Term& term : c.functional.terms)
    if (term.measured) s.label = term.measured->label;
  c.synthetic = std::move(s);
}

}  // namespace kerf

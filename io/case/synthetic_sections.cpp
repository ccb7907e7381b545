// [synthetic]: the true body from which measurements are made up. Its element differs from that of the search, and its
// mesh is finer by 0.7: data of the same discretisation would be fitted too well (an inverse crime).

#include "io/case/sections.hpp"
#include "kerf/element.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace kerf {

namespace {

/// Another element than that of the search.
Element other_element(const Value& table, const Case& c, const Scene& scene) {
  const auto name = find(table, "element"), degree = find(table, "degree");
  const Value& blamed = name ? *name : degree ? *degree : table;
  const Element e = read_element(table, blamed, name ? bdms(1) : c.optimize_element.name == "afw" ? bdms(2) : afw(2));
  if (e.name == c.optimize_element.name && e.degree == c.optimize_element.degree)
    fail(blamed.node->position,
         fmt::format("{}: the data would be made with the element \"{}\" of degree {} that looks for the answer: an "
                     "inverse crime; choose another element or degree",
                     blamed.name, e.name, e.degree));
  const bool contact = has_contact(scene);
  const auto why = refusal(e, can_contact);
  if (contact && why) fail(blamed.node->position, fmt::format("{}: {}", blamed.name, *why));
  return e;
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
  allow_only(*table);
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
  for (const Value& crack : cracks)
    if (const auto field = find(crack, "pressure"))
      fail(field->node->position,
           field->name + ": a crack that is to be found carries no load; leave the pressure out");
  add_holes(holes, s.true_shape);
  add_cracks(cracks, s.true_shape, s.true_scene.laws);
  for (const Value& region : regions)
    if (const auto strain = find(region, "eigenstrain"))
      fail(strain->node->position, strain->name + ": the true body has the eigenstrain of the case; leave it out");
  add_regions(regions, {{c.young, c.poisson, c.orthotropy}, c.plane_strain}, s.true_shape, s.true_scene.regions);
  s.element = other_element(*table, c, s.true_scene);

  s.sizing = c.sizing;
  constexpr double finer = 0.7;
  s.sizing.size = finer * target_size(c.sizing, c.shape);
  s.sizing.crack_tip_size = finer * c.sizing.crack_tip_size;  // 0 stays: it follows from the size
  take(*table, "size", s.sizing.size);
  take(*table, "crack_tip_size", s.sizing.crack_tip_size);
  take(*table, "noise", s.noise);
  s.spacing = target_size(c.sizing, c.shape);
  take(*table, "spacing", s.spacing);
  take(*table, "seed", s.seed);
  for (const Term& term : c.functional.terms)
    if (term.measured) s.label = term.measured->label;
  c.synthetic = std::move(s);
}

}  // namespace kerf

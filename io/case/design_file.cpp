// A design as a case file: the document of its case with another body. Written are the title, the design's outline,
// holes, cracks (whole or the pieces that a hole left of them, with the laws and formulas of the whole) and regions;
// what follows is the rest of the original document without the tables that describe the old body or guide the search.
// Numbers have all their digits, so that reading the file back gives the same doubles; sides along circles are written
// as arcs (circular(), 1e-4 of the extent). Names of files are made relative to the new folder, definitions that
// nothing uses any more are dropped because the reader refuses them, and comments at the head say what the file cannot
// say.

#include "geometry/arc_chain.hpp"
#include "geometry/plane.hpp"
#include "io/case/named_files.hpp"
#include "io/case/write.hpp"
#include "io/design.hpp"
#include "io/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace kerf {

namespace {

std::string pair(const Vec2& x) {
  return fmt::format("[{}, {}]", number(x.x()), number(x.y()));
}

const Node* find(const Node& table, std::string_view key) {
  const auto entry =
      std::find_if(table.entries.begin(), table.entries.end(), [&](const Entry& e) { return e.key == key; });
  return entry == table.entries.end() ? nullptr : &entry->value;
}

/// Names of files, made relative to another folder.
void move_files(Node& document, const std::filesystem::path& from, const std::filesystem::path& to) {
  namespace fs = std::filesystem;
  for_each_file(document, [&](Node& name) {
    name.text = fs::absolute(from / name.text)
                    .lexically_normal()
                    .lexically_proximate(fs::absolute(to).lexically_normal())
                    .generic_string();
  });
}

// The body.

std::string corners(const Loop& loop) {
  std::vector<std::string> entries;
  const std::size_t n = loop.sides.size();
  for (std::size_t i = 0; i < n; ++i) {
    const auto& arc = loop.sides[(i + n - 1) % n].arc;  // that arrives
    const Vec2& x = loop.sides[i].start;
    entries.push_back(arc ? fmt::format("{{ arc_to = {}, center = {} }}", pair(x), pair(arc->center)) : pair(x));
  }
  return fmt::format("[\n  {},\n]", fmt::join(entries, ",\n  "));
}

bool is_whole(const Loop& loop) {
  return loop.sides.size() == 1 && loop.sides.front().arc;
}

/// circle, ellipse, polygon or outline.
std::string form(const Loop& loop) {
  if (is_whole(loop)) {
    const Arc& arc = *loop.sides.front().arc;
    const Vec2 p = arc.axes.col(0), q = arc.axes.col(1);
    // Equal up to one rounding: what was a circle is one again.
    if ((arc.axes - p.norm() * Mat2::Identity()).norm() <= 1e-15 * p.norm())
      return fmt::format("circle = {{ center = {}, radius = {} }}", pair(arc.center), number(p.norm()));
    return fmt::format("ellipse = {{ center = {}, semi_axes = [{}, {}], angle_deg = {} }}", pair(arc.center),
                       number(p.norm()), number(q.norm()), number(std::atan2(p.y(), p.x()) * 180 / pi));
  }
  if (std::any_of(loop.sides.begin(), loop.sides.end(), [](const Side& s) { return s.arc.has_value(); }))
    return "outline = " + corners(loop);
  return "polygon = " + corners(loop);
}

std::string file_name(std::string name) {
  std::replace_if(
      name.begin(), name.end(),
      [](char c) { return !std::isalnum(static_cast<unsigned char>(c)) && c != '_' && c != '.' && c != '-'; }, '_');
  return name;
}

std::string unused(std::string name, std::set<std::string>& used) {
  const std::string first = name;
  for (int k = 2; !used.insert(name).second; ++k) name = fmt::format("{}_{}", first, k);
  return name;
}

void add_domain(const Shape& shape, std::string& out) {
  std::vector<std::string> labels;
  for (const Side& side : shape.outline.sides) labels.push_back(quoted(shape.labels[std::size_t(side.label)]));
  out += fmt::format("[domain]\noutline = {}\nsides = [{}]\n\n", corners(shape.outline), fmt::join(labels, ", "));
}

void add_holes(const Shape& shape, std::string& out) {
  std::set<std::string> used;
  for (const Loop& hole : shape.holes) {
    const std::string name = unused(file_name(hole.name), used);
    out += fmt::format("[[hole]]\nname = {}\n", quoted(name));
    const auto label = [&](const Side& side) { return shape.labels[std::size_t(side.label)]; };
    const std::string first = label(hole.sides.front());
    const bool same =
        std::all_of(hole.sides.begin(), hole.sides.end(), [&](const Side& s) { return label(s) == first; });
    const bool own = same && first == "hole:" + name;
    out += (own || is_whole(hole) ? form(hole) : "outline = " + corners(hole)) + "\n";
    std::vector<std::string> labels;
    for (const Side& side : hole.sides) labels.push_back(quoted(label(side)));
    if (!own) out += fmt::format("sides = {}\n", same ? labels.front() : fmt::format("[{}]", fmt::join(labels, ", ")));
    out += "\n";
  }
}

/// "c" of its piece "c.2".
std::string whole_of(const std::string& piece) {
  return piece.substr(0, piece.rfind('.'));
}

/// What the case says of the loads and gaps of a crack, or of the one that it is a piece of.
std::vector<Entry> formulas_of(const Node& document, const std::string& crack) {
  const Node* all = find(document, "crack");
  for (const std::string& name : {crack, whole_of(crack)})
    for (std::size_t i = 0; all && i < all->items.size(); ++i) {
      const Node* called = find(all->items[i], "name");
      if (!called || called->text != name) continue;
      std::vector<Entry> formulas;
      for (const Entry& entry : all->items[i].entries)
        if (entry.key == "pressure" || entry.key == "gap") formulas.push_back(entry);
      return formulas;
    }
  return {};
}

void add_cracks(const Case& c, const Shape& shape, std::span<const CrackLaw> laws, std::string& out) {
  std::set<std::string> used;
  for (std::size_t k = 0; k < shape.cracks.size(); ++k) {
    const Crack& crack = shape.cracks[k];
    out += fmt::format("[[crack]]\nname = {}\n", quoted(unused(file_name(crack.name), used)));
    std::vector<std::string> points;
    for (const Vec2& x : crack.points) points.push_back(pair(x));
    if (crack.arc)
      out += fmt::format("arc = {{ center = {}, radius = {}, from_deg = {}, to_deg = {} }}\n", pair(crack.arc->center),
                         number(crack.arc->axes.col(0).norm()), number(crack.arc->from * 180 / pi),
                         number(crack.arc->to * 180 / pi));
    else
      out += fmt::format("path = [{}]\n", fmt::join(points, ", "));
    out += fmt::format("contact = {}\n", quoted(std::string(word(laws[k].kind))));
    if (laws[k].friction > 0) out += fmt::format("friction = {}\n", number(laws[k].friction));
    if (laws[k].slip_bound > 0) out += fmt::format("tresca = {}\n", number(laws[k].slip_bound));
    for (const Entry& formula : formulas_of(*c.document, crack.name)) add_entry(formula, out);
    out += "\n";
  }
}

void add_regions(const Shape& shape, std::span<const Elastic> elastic, std::string& out) {
  for (std::size_t k = 0; k < shape.regions.size(); ++k)
    out += fmt::format("[[region]]\nname = {}\n{}\nyoung = {}\npoisson = {}\n\n", quoted(shape.regions[k].name),
                       form(shape.regions[k]), number(elastic[k].young), number(elastic[k].poisson));
}

// What is left of the case.

void collect_names(const Node& node, std::set<std::string>& names) {
  if (node.kind == Node::Kind::String) {
    std::string word;
    for (const char c : node.text + " ") {
      if (std::isalnum(static_cast<unsigned char>(c)) || c == '_') {
        word += c;
        continue;
      }
      names.insert(word);
      word.clear();
    }
  }
  for (const Node& item : node.items) collect_names(item, names);
  for (const Entry& entry : node.entries) collect_names(entry.value, names);
}

/// Definitions that nothing else uses any more are an error: they go, too. `names` are used by what is not there.
void drop_unused_definitions(Node& document, std::set<std::string> names) {
  for (const Entry& entry : document.entries)
    if (entry.key != "define") collect_names(entry.value, names);
  for (Entry& entry : document.entries) {
    if (entry.key != "define") continue;
    std::vector<Entry> kept;
    for (auto definition = entry.value.entries.rbegin(); definition != entry.value.entries.rend(); ++definition)
      if (names.contains(definition->key)) {  // they use only earlier ones
        collect_names(definition->value, names);
        kept.insert(kept.begin(), *definition);
      }
    entry.value.entries = std::move(kept);
  }
  std::erase_if(document.entries, [](const Entry& e) { return e.key == "define" && e.value.entries.empty(); });
}

/// What was made up from the true body is read from where it was written: beside the design.
void read_what_was_made_up(Node& node) {
  for (Node& item : node.items) read_what_was_made_up(item);
  for (Entry& entry : node.entries)
    if (entry.key == "measured" && entry.value.text == "synthetic")
      entry.value.text = "measured.csv";
    else
      read_what_was_made_up(entry.value);
}

/// The document without its body and without what is about other bodies; load cases keep a table [optimize], without
/// what begins or guides it.
Node rest_of_case(const Case& c, const Shape& design, const std::filesystem::path& folder) {
  static const std::set<std::string> body{"title", "domain", "hole",     "crack",    "region",
                                          "map",   "probe",  "validate", "synthetic"};
  static const std::set<std::string> guides{"start",        "symmetry", "frozen",        "hole",
                                            "crack",        "region",   "method",        "defects",
                                            "min_distance", "starts",   "least_squares", "keep_out"};
  Node rest = *c.document;
  std::erase_if(rest.entries, [&](const Entry& e) { return body.contains(e.key); });
  const bool cases = c.optimize && !c.optimize->load_cases.empty();
  if (!cases) std::erase_if(rest.entries, [](const Entry& e) { return e.key == "optimize"; });
  for (Entry& entry : rest.entries)
    if (entry.key == "optimize") {
      std::erase_if(entry.value.entries, [&](const Entry& e) { return guides.contains(e.key); });
      if (c.optimize->method == OptimizeMethod::LevelSet) continue;
      // It reads as a level set now, which must have something to do.
      std::erase_if(entry.value.entries, [](const Entry& e) { return e.key == "volume"; });
      Node most, volume;
      most.kind = Node::Kind::Float;
      most.number = 0.99;
      volume.entries.push_back({"at_most", {}, most});
      entry.value.entries.push_back({"volume", {}, volume});
    }
  move_files(rest, c.folder, folder);
  read_what_was_made_up(rest);
  for (Entry& entry : rest.entries)
    if (entry.key == "mesh")  // the design is drawn
      std::erase_if(entry.value.entries, [](const Entry& e) { return e.key == "mesher"; });
  std::set<std::string> in_cracks;
  for (const Crack& crack : design.cracks)
    for (const Entry& formula : formulas_of(*c.document, crack.name)) collect_names(formula.value, in_cracks);
  drop_unused_definitions(rest, std::move(in_cracks));
  return rest;
}

/// What the file cannot say.
std::vector<std::string> limits(const Case& c, const DesignFile& design) {
  std::vector<std::string> all;
  if (c.optimize && !c.optimize->load_cases.empty())
    all.push_back("kerf solve computes the first load case by name; J above is the weighted sum over all of them.");
  if (c.synthetic) all.push_back("its data are measured.csv, straight between the sensors: J may differ a little.");
  std::set<std::string> first;
  for (const Crack& crack : c.shape.cracks) first.insert(crack.name);
  if (c.element.degree > c.optimize_element.degree)
    all.push_back(
        "kerf solve takes elements of one degree more than the iterations did: J may differ in its third digit.");
  for (const Crack& crack : design.shape.cracks)
    if (!first.contains(crack.name) && first.contains(whole_of(crack.name)))
      all.push_back(fmt::format("crack {} is a piece of another one: functionals of that one see its first piece only.",
                                crack.name));
  for (const CrackLaw& law : design.laws)
    if (is_unilateral(law)) {
      all.push_back("where contact ends kerf solve makes the mesh finer: J may differ in its fourth digit.");
      break;
    }
  const auto polygonal = [](const Loop& loop) {
    return std::any_of(loop.sides.begin(), loop.sides.end(), [](const Side& s) { return s.smooth && !s.arc; });
  };
  if (polygonal(design.shape.outline) || std::any_of(design.shape.holes.begin(), design.shape.holes.end(), polygonal))
    if (std::none_of(design.shape.outline.sides.begin(), design.shape.outline.sides.end(),
                     [](const Side& s) { return s.smooth && s.arc; }) &&
        std::none_of(design.shape.holes.begin(), design.shape.holes.end(), [](const Loop& h) {
          return std::any_of(h.sides.begin(), h.sides.end(), [](const Side& s) { return s.smooth && s.arc; });
        }))
      all.push_back("its curved sides are polygons, and their corners may get finer meshes than before.");
  return all;
}

}  // namespace

std::string design_case(const Case& c, const DesignFile& design, const std::filesystem::path& folder) {
  const Shape shape = circular(design.shape, 1e-4 * extent(design.shape));
  std::string out;
  for (const std::string& line : design.comments) out += fmt::format("# {}\n", clean_text(line));
  for (const std::string& line : limits(c, design)) out += fmt::format("# {}\n", clean_text(line));
  out += fmt::format("title = {}\n", quoted(c.title + " (design)"));
  out += "\n";
  add_domain(shape, out);
  add_holes(shape, out);
  add_cracks(c, shape, design.laws, out);
  add_regions(shape, design.regions, out);
  for (const Entry& table : rest_of_case(c, shape, folder).entries) add_entry(table, out);
  while (out.ends_with("\n\n")) out.pop_back();
  return out;
}

}  // namespace kerf

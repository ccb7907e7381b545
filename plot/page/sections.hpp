#pragma once
// The sections of the page, as HTML. Figures and curves are elements that the browser fills (script.hpp).

#include "plot/page.hpp"
#include "plot/page/html.hpp"

namespace kerf {

/// A line per job: what is said of it, and why.
std::string verdicts(const Result& result);
std::string key_numbers(const Result& result);

/// A figure of the body: caption and description say what is seen there. Nothing without arrays.
struct Finding {
  std::string title, text;  // plain
};
Finding stress_finding(const Result& result);
Finding map_finding(const Result& result);
std::string body_figure(const char* id, const Finding& finding);
/// Why the figures have fewer triangles than the mesh; empty where they have all.
std::string thinned(const Result& result, const PageData& data);

std::string map_section(const Result& result, const std::string& figure);
std::string cracks_section(const Result& result);
/// A row per load case.
std::string load_cases_section(const Result& result);
/// The history of [[step]]: slots of its curves, and a table.
std::string steps_section(const Result& result);
/// Curves and a table of cracks that grew.
std::string growth_section(const GrowthResult& growth, const PageData& data);
/// The worst edge cracks and what they do to the life, and those that were drawn.
std::string edge_cracks_section(const EdgeCrackResult& cracks, const Units& units);
/// Where quantities are bounded.
std::string bounds_section(const Result& result);
std::string validation_section(const Result& result);
std::string optimize_section(const Result& result, const PageData& data);
/// Mesh, state and contact.
std::string tables_section(const Result& result);

}  // namespace kerf

#pragma once
// The report page.

#include "io/arrays.hpp"
#include "io/result.hpp"

namespace kerf {

/// What a page draws beside the numbers of a result. Arrays of corners: points (2), u (2), stress (xx, yy, xy),
/// von_mises, map, lower, upper, margin (of the mask), near (a Near each), left_out (0, 1 masked, 2 near a singular
/// point). Of triangles: triangles (3 corners), error_indicator, angle. Pairs of corners: outline, interfaces, cracks.
/// Places: supports, rollers, arrows (4: from, to). Of a design: design.shots (iteration, objective, volume),
/// design.lines (shot, 0 boundary | 1 crack, points), design.points (2); found.lines (0 start | 1 true | 2 found | 3
/// uncertainty | 4 frame, points), found.points.
struct PageData {
  std::vector<NamedArray> arrays;  // none: a page without figures of the body
  std::string case_text;           // case.toml
};

/// One self-contained page that opens without a network: verdicts, key numbers, figures drawn by the browser from
/// arrays inside, tables that need no script.
std::string page(const Result& result, const PageData& data);

/// Fewer triangles in the same arrays, where there are more than so many: vertices inside the body become one with a
/// neighbor, evenly over the mesh, and no triangle turns over. Lines stay, so that there may be more than that.
void thin(std::vector<NamedArray>& arrays, std::size_t at_most);
inline constexpr std::size_t most_triangles = 60000;

/// Throws Error(Files) naming the path.
void write_page(const std::filesystem::path& path, const Result& result, const PageData& data);

}  // namespace kerf

#pragma once
// Pieces of HTML. Texts come in as they are and are escaped here, but for cells and values: these arrive as HTML.

#include "io/result.hpp"

namespace kerf {

inline constexpr std::size_t most_rows = 200;  // of a table

std::string at_place(const Vec2& p);
/// A dash for nothing.
std::string number_or_dash(const std::optional<double>& v);
/// A number with its unit, where there is one.
std::string with_unit(double value, const Units& units, const std::optional<Dimension>& dimension);

/// Rows of name and value; values arrive as HTML.
struct Facts {
  std::string html;
  void add(const std::string& name, const std::string& value);
  std::string table() const;
};

/// `words`: columns of running text, which wraps; from 0.
std::string table(const std::vector<std::string>& heads, const std::vector<std::vector<std::string>>& rows,
                  std::span<const std::size_t> words = {});

/// Open when it is asked for, and on paper.
std::string folded(const std::string& summary, const std::string& html);
/// The same as a section of the page.
std::string folded_section(const std::string& title, const std::string& summary, const std::string& html);

/// What a finer mesh does not change first.
/// "reserve against yield": "2.31: von Mises stress 108.2 of 250 MPa at (1, 2)".
void add_reserve(Facts& facts, const ReserveResult& reserve, const Units& units);
void add_peak(Facts& facts, const std::string& name, const Peak& peak, const Units& units, const Dimension& of);

std::string note(const std::string& text, bool bad = false);

}  // namespace kerf

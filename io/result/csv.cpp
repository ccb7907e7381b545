// Tables as comma-separated values: rows along a crack, intervals, steps of a history. A number has the shortest text
// that reads back to the same double; one that is not finite is an empty cell. Texts with commas, quotes or line ends
// are quoted. Columns that only some cracks have (fluid_pressure, gap) come last, so that the others keep their places.
// A step k of n parts stands in the history at (steps before) + k / n.

#include "io/csv.hpp"
#include "io/growth_columns.hpp"

#include "io/files.hpp"
#include "io/result.hpp"

#include <cmath>

#include <map>

namespace kerf {

void append_cell(fmt::memory_buffer& out, double value) {
  if (std::isfinite(value)) fmt::format_to(std::back_inserter(out), "{}", value);
}

std::string csv_text(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? "\"\"" : std::string(1, c);
  return out + '"';
}

void write_csv(const std::filesystem::path& path, const std::vector<std::string>& columns,
               const std::vector<std::vector<double>>& rows) {
  fmt::memory_buffer out;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    fmt::format_to(std::back_inserter(out), "{}{}", i > 0 ? "," : "", csv_text(columns[i]));
  }
  out.push_back('\n');
  for (const auto& row : rows) {
    if (row.size() != columns.size()) {
      throw std::invalid_argument(
          fmt::format("a row of '{}' has {} values; {} would be right", path.string(), row.size(), columns.size()));
    }
    for (std::size_t i = 0; i < row.size(); ++i) {
      if (i > 0) out.push_back(',');
      append_cell(out, row[i]);
    }
    out.push_back('\n');
  }
  write_file(path, {out.data(), out.size()});
}

void write_crack_csv(const std::filesystem::path& path, const CrackResult& crack) {
  fmt::memory_buffer out;
  const bool fluid = crack.fluid_pressure.has_value();
  fmt::format_to(std::back_inserter(out), "s,x,y,jump_n,jump_t,sigma_n,sigma_t,status{}{}\n",
                 fluid ? ",fluid_pressure" : "", crack.has_gap ? ",gap" : "");
  for (const CrackRow& row : crack.rows) {
    for (const double value : {row.s, row.at.x(), row.at.y(), row.jump_n, row.jump_t, row.sigma_n, row.sigma_t}) {
      append_cell(out, value);
      out.push_back(',');
    }
    fmt::format_to(std::back_inserter(out), "{}", row.closed ? "closed" : "open");
    if (fluid) {
      out.push_back(',');
      append_cell(out, row.fluid_pressure);
    }
    if (crack.has_gap) {
      out.push_back(',');
      append_cell(out, row.gap);
    }
    out.push_back('\n');
  }
  write_file(path, {out.data(), out.size()});
}

void write_bounds_csv(const std::filesystem::path& path, const BoundsResult& bounds) {
  fmt::memory_buffer out;
  fmt::format_to(std::back_inserter(out),
                 "quantity,crack,tip,x,y,value,lower,upper,guaranteed,note,on,radius,to_x,to_y\n");
  const auto row = [&](std::string_view quantity, const std::string& crack, const char* tip, const Vec2& at,
                       const Bounded& b, const BoundedMean* mean = nullptr) {
    fmt::format_to(std::back_inserter(out), "{},{},{},", quantity, csv_text(crack), tip);
    for (const double value : {at.x(), at.y(), b.value, b.lower, b.upper}) {
      append_cell(out, value);
      out.push_back(',');
    }
    fmt::format_to(std::back_inserter(out), "{},{},{}", b.guaranteed ? "yes" : "no", csv_text(b.note),
                   mean ? csv_text(mean->on) : std::string());
    const bool disc = mean && mean->of == BoundedMean::Of::Disc, line = mean && mean->of == BoundedMean::Of::Line;
    for (const double value : {disc ? mean->radius : nan, line ? mean->to.x() : nan, line ? mean->to.y() : nan}) {
      out.push_back(',');
      append_cell(out, value);
    }
    out.push_back('\n');
  };
  for (const BoundedTip& t : bounds.tips) {
    const char* tip = t.at_start ? "start" : "end";
    row("K_I", t.crack, tip, t.at, t.K_I);
    row("K_II", t.crack, tip, t.at, t.K_II);
    row("G", t.crack, tip, t.at, t.G);
  }
  for (const BoundedPoint& p : bounds.points) {
    row("s_xx", "", "", p.at, p.s_xx);
    row("s_yy", "", "", p.at, p.s_yy);
    row("s_xy", "", "", p.at, p.s_xy);
    row("von_mises", "", "", p.at, p.von_mises);
    row("topological_derivative", "", "", p.at, p.derivative);
  }
  for (const BoundedMean& m : bounds.means) {
    const std::span<const NamedQuantity> names = quantities_of(m.of);
    const bool placed = m.of == BoundedMean::Of::Disc || m.of == BoundedMean::Of::Line;
    const Vec2 at = placed ? m.from : Vec2(nan, nan);
    for (std::size_t i = 0; i < m.quantities.size(); ++i) row(names[i].name, "", "", at, m.quantities[i], &m);
  }
  write_file(path, {out.data(), out.size()});
}

std::vector<std::string> tips_of(const GrowthResult& growth) {
  std::vector<std::string> names;
  for (const growth::GrowthStep& s : growth.steps)
    for (const growth::GrownTip& t : s.tips)
      if (std::ranges::find(names, t.name) == names.end()) names.push_back(t.name);
  return names;
}

void write_beta_csv(const std::filesystem::path& path, const GrowthResult& growth, const std::string& tip,
                    double stress) {
  fmt::memory_buffer out;
  fmt::format_to(std::back_inserter(out), "a,beta,K_max\n");
  const auto crack_of = [](const std::string& name) { return name.substr(0, name.rfind(':')); };
  const auto ends = std::ranges::count_if(tips_of(growth),
                                          [&](const std::string& other) { return crack_of(other) == crack_of(tip); });
  for (const growth::GrowthStep& s : growth.steps)
    for (const growth::GrownTip& t : s.tips) {
      if (t.name != tip) continue;
      const double a = t.a / static_cast<double>(ends);
      append_cell(out, a);
      for (const double value : {t.K_max / (stress * std::sqrt(pi * a)), t.K_max}) {
        out.push_back(',');
        append_cell(out, value);
      }
      out.push_back('\n');
    }
  write_file(path, {out.data(), out.size()});
}

void write_growth_csv(const std::filesystem::path& path, const GrowthResult& growth) {
  fmt::memory_buffer out;
  fmt::format_to(std::back_inserter(out), "step,cycles,load,tip,x,y");
  for (const auto& [name, member] : columns_of_tip) fmt::format_to(std::back_inserter(out), ",{}", name);
  const bool bounds = std::ranges::any_of(growth.steps, [](const growth::GrowthStep& s) {
    return std::ranges::any_of(s.tips, [](const growth::GrownTip& t) { return t.in.has_value(); });
  });
  if (bounds) {
    for (const auto& [name, member] : intervals_of_tip)
      fmt::format_to(std::back_inserter(out), ",{0}_lower,{0}_upper", name);
    fmt::format_to(std::back_inserter(out), ",guaranteed");
  }
  out.push_back('\n');
  for (const growth::GrowthStep& s : growth.steps)
    for (const growth::GrownTip& t : s.tips) {
      fmt::format_to(std::back_inserter(out), "{},", s.number);
      append_cell(out, s.cycles);
      out.push_back(',');
      append_cell(out, s.load);
      fmt::format_to(std::back_inserter(out), ",{}", csv_text(t.name));
      for (const double value : {t.at.x(), t.at.y()}) {
        out.push_back(',');
        append_cell(out, value);
      }
      for (const auto& [name, member] : columns_of_tip) {
        out.push_back(',');
        append_cell(out, t.*member);
      }
      const growth::TipIntervals in = t.in.value_or(growth::TipIntervals{});
      for (const auto& [name, member] : intervals_of_tip)
        for (const double value : {(in.*member).low, (in.*member).high}) {
          if (!bounds) continue;
          out.push_back(',');
          append_cell(out, value);
        }
      if (bounds) fmt::format_to(std::back_inserter(out), ",{}", in.guaranteed ? 1 : 0);
      out.push_back('\n');
    }
  write_file(path, {out.data(), out.size()});
}

std::vector<double> places_in_history(const std::vector<StepResult>& steps) {
  std::vector<double> out;
  double before = 0;
  for (const StepResult& s : steps) {
    out.push_back(before + static_cast<double>(s.part) / s.parts);
    if (s.part == s.parts) ++before;
  }
  return out;
}

void write_steps_csv(const std::filesystem::path& path, const std::vector<StepResult>& steps) {
  std::vector<std::string> columns{"step"};
  for (const auto& [name, value] : steps.front().values) columns.push_back(name);
  for (const char* column : {"energy", "strain_energy", "work", "dissipation", "imbalance", "open_length",
                             "closed_length", "stick_length", "slip_length"})
    columns.emplace_back(column);
  std::map<std::string, int> number;  // of the tips of a crack
  for (const StepResult::Tip& tip : steps.front().tips) {
    const int k = ++number[tip.crack];
    for (const char* of : {"K_I", "K_II"}) columns.push_back(fmt::format("{}_{}_{}", of, tip.crack, k));
  }
  const std::vector<double> places = places_in_history(steps);
  std::vector<std::vector<double>> rows;
  for (const StepResult& s : steps) {
    std::vector<double> row{places[rows.size()]};
    for (const auto& [name, value] : s.values) row.push_back(value);
    for (const double value : {s.energy, s.strain_energy, s.work, s.dissipation, s.imbalance, s.open_length,
                               s.closed_length, s.stick_length, s.slip_length})
      row.push_back(value);
    for (const StepResult::Tip& tip : s.tips)
      for (const auto& K : {tip.K_I, tip.K_II}) row.push_back(K.value_or(nan));
    rows.push_back(std::move(row));
  }
  write_csv(path, columns, rows);
}

}  // namespace kerf

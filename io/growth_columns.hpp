#pragma once
// The numbers of a tip that grows, as result.json and growth.csv call them.

#include "kerf/growth.hpp"

#include <utility>

namespace kerf {

/// By name, in the order of both files.
inline constexpr std::pair<const char*, double growth::GrownTip::*> columns_of_tip[] = {
    {"a", &growth::GrownTip::a},
    {"K_I", &growth::GrownTip::K_I},
    {"K_II", &growth::GrownTip::K_II},
    {"T", &growth::GrownTip::T},
    {"G", &growth::GrownTip::G},
    {"K_max", &growth::GrownTip::K_max},
    {"K_I_min", &growth::GrownTip::K_I_min},
    {"K_II_min", &growth::GrownTip::K_II_min},
    {"dK", &growth::GrownTip::dK},
    {"rate", &growth::GrownTip::rate},
    {"da", &growth::GrownTip::da},
    {"angle", &growth::GrownTip::angle},
    {"symmetry", &growth::GrownTip::symmetry}};

/// Of intervals, with _lower and _upper.
inline constexpr std::pair<const char*, Interval growth::TipIntervals::*> intervals_of_tip[] = {
    {"K_I", &growth::TipIntervals::K_I}, {"K_II", &growth::TipIntervals::K_II}, {"G", &growth::TipIntervals::G}};
inline constexpr std::pair<const char*, Interval growth::PathBounds::*> intervals_of_path[] = {
    {"cycles", &growth::PathBounds::cycles},
    {"cycles_smooth", &growth::PathBounds::cycles_smooth},
    {"released", &growth::PathBounds::released},
    {"lost", &growth::PathBounds::lost}};

}  // namespace kerf

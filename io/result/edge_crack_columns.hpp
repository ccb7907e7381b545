#pragma once
// The numbers of edge cracks, as result.json and the CSV files call them; angles, in degrees, stand before them.

#include "inspect/interior.hpp"
#include "kerf/edge_cracks.hpp"

#include <utility>

namespace kerf {

inline constexpr std::pair<const char*, double inspect::EdgeCrack::*> columns_of_edge_crack[] = {
    {"K", &inspect::EdgeCrack::K},
    {"K_I", &inspect::EdgeCrack::K_I},
    {"K_II", &inspect::EdgeCrack::K_II},
    {"G", &inspect::EdgeCrack::G},
    {"curvature", &inspect::EdgeCrack::curvature},
    {"stress", &inspect::EdgeCrack::stress},
    {"gradient", &inspect::EdgeCrack::gradient},
    {"first_order", &inspect::EdgeCrack::first_order},
    {"valid_length", &inspect::EdgeCrack::valid_length},
    {"corner", &inspect::EdgeCrack::corner}};
inline constexpr std::pair<const char*, double inspect::InteriorCrack::*> columns_of_interior_crack[] = {
    {"K", &inspect::InteriorCrack::K}, {"K_I", &inspect::InteriorCrack::K_I}, {"K_II", &inspect::InteriorCrack::K_II}};
inline constexpr std::pair<const char*, double inspect::Tolerance::*> columns_of_tolerance[] = {
    {"critical_length", &inspect::Tolerance::critical_length},
    {"cycles", &inspect::Tolerance::cycles},
    {"interval", &inspect::Tolerance::interval}};
inline constexpr std::pair<const char*, double inspect::DrawnEdge::*> columns_of_drawn_edge[] = {
    {"length", &inspect::DrawnEdge::length},
    {"K_I", &inspect::DrawnEdge::K_I},
    {"K_II", &inspect::DrawnEdge::K_II},
    {"spread", &inspect::DrawnEdge::spread},
    {"predicted_I", &inspect::DrawnEdge::predicted_I},
    {"predicted_II", &inspect::DrawnEdge::predicted_II},
    {"first_order", &inspect::DrawnEdge::first_order},
    {"error", &inspect::DrawnEdge::error}};

}  // namespace kerf

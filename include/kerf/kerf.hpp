#pragma once
// The whole of kerf. Parts that a build left out (case files, VTK, optimization) have no header.

#include "kerf/adaptive.hpp"
#include "kerf/adjoint.hpp"
#include "kerf/analysis.hpp"
#include "kerf/bounds.hpp"
#include "kerf/element.hpp"
#include "kerf/field.hpp"
#include "kerf/fracture.hpp"
#include "kerf/functional.hpp"
#include "kerf/map.hpp"
#include "kerf/material.hpp"
#include "kerf/max_stress.hpp"
#include "kerf/mesh.hpp"
#include "kerf/mesh_file.hpp"
#include "kerf/mesher.hpp"
#include "kerf/model.hpp"
#include "kerf/perturbation.hpp"
#include "kerf/recover.hpp"
#include "kerf/scene.hpp"
#include "kerf/second_order.hpp"
#include "kerf/shape.hpp"
#include "kerf/shape_gradient.hpp"
#include "kerf/state.hpp"
#include "kerf/stop.hpp"
#include "kerf/types.hpp"
#include "kerf/units.hpp"
#include "kerf/validate.hpp"

#if __has_include("kerf/optimize.hpp")
#include "kerf/derivative_bounds.hpp"
#include "kerf/design.hpp"
#include "kerf/inverse.hpp"
#include "kerf/optimize.hpp"
#endif
#if __has_include("kerf/case_file.hpp")
#include "kerf/case_file.hpp"
#endif
#if __has_include("kerf/vtk.hpp")
#include "kerf/vtk.hpp"
#endif

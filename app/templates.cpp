// Commented cases for `kerf init`, as texts: a plate with a hole, a cracked plate, and others, each with a line of
// description. They are cases like any other. A new template is a text and a row in the table at the end. Comments in
// them explain keys to users; docs/case-files.md has all keys.

#include "app/templates.hpp"

namespace kerf {

namespace {

const char* const plate =
    R"toml(# A plate with a hole, pulled: its stress, and where a further hole would change its energy most.
#
#   kerf check plate.toml        the geometry and what each label selects; solves nothing
#   kerf run   plate.toml        results in out/plate; open report.html
#
# Units are yours: a length, a stress, and everything else follows.

title = "Plate with a hole"

[domain]
outline = [[0, 0], [2, 0], [2, 1], [0, 1]]       # corners of a simple polygon, in order
sides   = ["bottom", "right", "top", "left"]     # a label per edge: corner 1 to 2, 2 to 3, ...

[[hole]]                                         # any number; circle, ellipse or polygon
name   = "h"                                     # its rim is the label "hole:h"; without a condition it is free
circle = { center = [0.7, 0.5], radius = 0.2 }

[material]
young   = 1000
poisson = 0.3
state   = "plane strain"                         # or "plane stress"

[[boundary]]                                     # sides without a condition are free
on           = "left"
displacement = [0, 0]                            # or displacement_x, _y, _normal alone: a roller

[[boundary]]
on       = "right"
traction = [1, 0]                                # numbers or expressions: ["1 + y", 0]

[mesh]
size = 0.05                                      # target edge length
# adapt = { error = 0.01 }                       # refine until the estimated relative error of the stress is below

[functional]                                     # what J is; see docs/case-files.md for all kinds
kind = "energy"

[map]                                            # the topological derivative of J
perturbation = "hole"                            # or "clamped_hole", "crack", { young = 10, poisson = 0.3 }, { aspect = 3 }

[[probe]]                                        # values at points, in probe_<name>.csv
name  = "middle"
from  = [0, 0.5]
to    = [2, 0.5]
count = 41
# bounds = true                                  # guaranteed lower and upper values of the stresses, too

# [bounds]                                       # guaranteed lower and upper values of
# displacements = ["right"]                      # mean displacements; reactions = ["left"], compliance = true,
# disc = [{ center = [1, 0.5], radius = 0.1 }]   # mean stresses; line = [{ from = [0.5, 0.5], to = [1.5, 0.5] }]
)toml";

const char* const cracked =
    R"toml(# A plate with a crack that may open and close: contact, stress intensities, and whether the map is right.
#
#   kerf run cracked.toml        results in out/cracked; open report.html

title = "Cracked plate"

[domain]
outline = [[-2, -2], [2, -2], [2, 2], [-2, 2]]
sides   = ["bottom", "right", "top", "left"]

[[crack]]                                        # any number; they may cross, branch and end on the boundary
name    = "c"
path    = [[-1, 0], [1, 0.2]]                    # a polyline; or arc = { center, radius, from_deg, to_deg }
contact = "unilateral"                           # the faces do not penetrate and slide freely; or "open", "bonded"
# friction = 0.3                                 # Coulomb's coefficient; then no optimization

[material]
young   = 1000
poisson = 0.3
state   = "plane strain"

[[boundary]]
on           = "bottom"
displacement = [0, 0]

[[boundary]]
on       = "top"
traction = [0, "0.1 + x"]                        # pulls on the right, presses on the left

[mesh]
size           = 0.12
crack_tip_size = 0.002                           # small is cheap: the mesh grows from there

[functional]
kind = "energy_release_rate"                     # G of one tip
crack = "c"
tip   = "end"                                    # of the path

[map]                                            # where would a small hole relieve this tip?
perturbation = "hole"

[validate]                                       # is the map right? holes of a few radii, and the verdict
points = [[0.6, 1.1]]
radii  = { largest = 0.16, ratio = 0.5, count = 5 }
)toml";

const char* const optimize =
    R"toml(# The stiffest cantilever of a given volume: a level set, holes appear where the topological derivative says so.
#
#   kerf optimize optimize.toml              results in out/optimize: report.html, design_NNNN.vtu, history.csv
#   kerf optimize optimize.toml --resume     goes on where it was stopped (Ctrl-C) or killed

title = "Cantilever"

[domain]                                         # the design lies inside
outline = [[0, 0], [2, 0], [2, 0.45], [2, 0.55], [2, 1], [0, 1]]
sides   = ["bottom", "right", "load", "right", "top", "left"]

[material]
young   = 1
poisson = 0.3
state   = "plane stress"

[[boundary]]
on           = "left"
displacement = [0, 0]

[[boundary]]
on       = "load"
traction = [0, -10]

[mesh]
size = 0.03

[functional]
kind = "compliance"                              # work of the loads

[optimize]
method         = "level-set"                     # or mma, ccsaq, slsqp, cobyla for holes drawn by a few numbers
volume         = { at_most = 0.4 }               # share of the area; or { penalty = 100 }
max_iterations = 100
nucleate       = { every = 5, fraction = 0.02 }  # or false
symmetry       = { y = 0.5 }                     # the design is its own mirror image about the line y = 0.5
# frozen       = ["pad"]                         # regions that stay solid: [[region]] name = "pad", circle = ...
# start        = { holes = [6, 3], radius = 0.1 }  # holes to begin with; or { random = 10, seed = 1, radius = 0.1 }

# [[optimize.bound]]                             # what must not be exceeded
# kind    = "stress_pnorm"
# p       = 8
# at_most = 50

# [[load_case]]                                  # several sets of loads: then all [[boundary]] loads move here
# name   = "down"
# weight = 1
# [[load_case.boundary]]
# on       = "load"
# traction = [0, -10]
)toml";

const char* const holes =
    R"toml(# Two holes placed, sized and turned so that a pulled plate stays as stiff as it can with less material.
#
#   kerf optimize holes.toml     results in out/holes: report.html, design_NNNN.vtu, history.csv

title = "Two holes in a pulled plate"

[domain]
outline = [[0, 0], [2, 0], [2, 1], [0, 1]]
sides   = ["bottom", "right", "top", "left"]

[[crack]]                                        # stays where it is
name = "c"
path = [[0.9, 0.1], [1.1, 0.2]]

[material]
young   = 1
poisson = 0.3

[[boundary]]
on           = "left"
displacement = [0, 0]

[[boundary]]
on       = "right"
traction = [1, 0]

[mesh]
size = 0.06

[functional]
kind = "compliance"

[optimize]
method         = "mma"                           # or ccsaq, slsqp, cobyla (without derivatives)
volume         = { at_most = 0.85 }
max_iterations = 60                              # evaluations of a design
min_distance   = 0.05                            # between holes, and to the crack and the outline

[[optimize.hole]]                                # a number is fixed, [low, high] is a variable
circle = { center = [[0.3, 0.8], [0.3, 0.7]], radius = [0.05, 0.3] }

[[optimize.hole]]
name    = "egg"
ellipse = { center = [[1.3, 1.7], [0.3, 0.7]], semi_axes = [[0.05, 0.4], [0.05, 0.3]], angle_deg = [-90, 90] }
start   = { center = [1.5, 0.5], semi_axes = [0.2, 0.15], angle_deg = 0 }

[[optimize.bound]]
kind    = "stress_pnorm"
p       = 6
at_most = 4
)toml";

const char* const inverse =
    R"toml(# Where is the hole? The displacements of three sides are known (here made up, with noise), the hole is not.
#
#   kerf optimize inverse.toml   results in out/inverse: report.html says what was found beside what is true

title = "A hole found from displacements of the boundary"

[domain]
outline = [[0, 0], [2, 0], [2, 1], [0, 1]]
sides   = ["measured", "measured", "measured", "left"]

[material]
young   = 1
poisson = 0.3
state   = "plane stress"

[[boundary]]
on           = "left"
displacement = [0, 0]

[[boundary]]
on       = "measured"
traction = ["nx", "0.5*ny"]

[mesh]
size = 0.06

[functional]
kind     = "misfit"                              # Kohn-Vogelius
on       = "measured"
measured = "synthetic"                           # or a file with the columns x,y,u_x,u_y

[synthetic]                                      # the true body, solved on another mesh with another element
noise = 0.01                                     # of the root mean square of the displacements
seed  = 1

[[synthetic.hole]]
name   = "true"
circle = { center = [1.3, 0.6], radius = 0.15 }

[optimize]
method         = "slsqp"
max_iterations = 60
tolerance      = 0.01

[[optimize.hole]]
circle = { center = [[0.2, 1.8], [0.2, 0.8]], radius = [0.03, 0.18] }
start  = "map"                                   # read off topological derivatives; or { center = [1, 0.5], radius = 0.1 }
)toml";

}  // namespace

const std::vector<Template>& templates() {
  static const std::vector<Template> all = {
      {"plate", "a plate with a hole: state, map of the energy, values along a line", plate},
      {"cracked", "a crack in contact: stress intensities, map of an energy release rate, its validation", cracked},
      {"optimize", "the stiffest cantilever of a given volume: a level set", optimize},
      {"holes", "holes drawn by a few numbers, placed and sized beside a crack", holes},
      {"inverse", "a hole found from displacements of the boundary", inverse}};
  return all;
}

}  // namespace kerf

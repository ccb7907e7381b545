// The keys of a case file, one row each, and how they are looked up. A path is that of the tables around the key,
// "optimize.hole[].circle.radius", where [] is an entry of a list. A table may be `like` another one and has the rows
// of that one, too: find_key and keys_in follow such references, the innermost first. `with` names what a key goes
// with: a key beside it, a kind, or a method; keys_in(table, variant) leaves out what does not go with the variant. The
// reader, `kerf keys`, the tables of docs/case-files.md, the JSON Schema and the completion of the shell are all made
// from this table, and tests compare what is in the repository with it.

#include "io/case/keys.hpp"

#include "kerf/case_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace kerf {

namespace {

using enum KeyType;
using View = std::string_view;

constexpr KeyRange above_zero{0, infinity, true};
constexpr KeyRange not_negative{0, infinity};
constexpr KeyRange poisson{-1, 0.5, true};  // what is stable

constexpr std::array<View, 2> plane_states{"plane strain", "plane stress"};
constexpr std::array<View, 9> element_names{
    "peers", "bdms", "bdms-c", "afw", "arnold-winther", "arnold-winther-c", "arnold-winther-nc", "p1", "p2"};
constexpr std::array<View, 8> length_words{"m", "mm", "cm", "um", "nm", "km", "in", "ft"};
constexpr std::array<View, 6> stress_words{"Pa", "kPa", "MPa", "GPa", "psi", "ksi"};
constexpr std::array<View, 14> functional_kinds{
    "energy",           "compliance",   "volume", "displacement_tracking", "boundary_tracking", "displacement",
    "stress_power",     "stress_pnorm", "misfit", "energy_release_rate",   "crack_opening",     "crack_pressure",
    "worst_edge_crack", "sum"};
constexpr std::array<View, 2> mesher_words{"kerf", "gmsh"};
constexpr std::array<View, 1> curved_words{"auto"};
constexpr std::array<View, 2> path_ends{"start", "end"};
constexpr std::array<View, 4> perturbation_words{"hole", "clamped_hole", "crack", "edge_crack"};
constexpr std::array<View, 1> from_map{"map"};
constexpr std::array<View, 1> worst_words{"worst"};
constexpr std::array<View, 1> counted{"auto"};
constexpr KeyWords drawn_laws = KeyWords(crack_law_words).first(2);  // a crack that is sought has faces

constexpr std::array<View, 5> law_words{"quasi-static", "paris", "walker", "forman", "nasgro"};

constexpr View level_set = "level-set", methods_of_drawn = "mma|ccsaq|slsqp|cobyla";

// The order within a table is that of messages.
constexpr Key rows[] = {
    {"title", Text, {}, "Headline of summary, pictures and report.", "\"Plate\"", "the file's name"},

    {"units",
     Table,
     {},
     "What the numbers of the file are measured in. Labels: nothing is converted, and results say them."},
    {"units.length", Word, {.words = length_words, .required = true}, "The unit of lengths.", "\"mm\""},
    {"units.stress",
     Word,
     {.words = stress_words, .required = true},
     "The unit of stresses and moduli. Forces and energies are per unit of thickness: with mm and MPa in N/mm.",
     "\"MPa\""},

    {"domain", Table, {.required = true}, "The body: an outline with a label per edge."},
    {"domain.outline",
     PointList,
     {.one_of = true},
     "Corners of a simple polygon, in order. An entry may be { arc_to = [x, y], center = [x, y] }: the edge that "
     "arrives there is an arc. Two entries make a disc.",
     "[[0, 0], [2, 0], [2, 1], [0, 1]]"},
    {"domain.outline[].arc_to", Pair, {.required = true}, "Where the arc ends.", "[1, 0]"},
    {"domain.outline[].center",
     Pair,
     {.required = true},
     "Its center, at the same distance from both ends. The arc runs the shorter way, counter-clockwise when both are "
     "equal.",
     "[0, 0]"},
    {"domain.sides",
     Names,
     {.with = "outline", .required = true},
     "A label per edge, corner 1 to 2 first; edges may share a label.",
     "[\"bottom\", \"right\", \"top\", \"left\"]"},
    {"domain.file",
     Text,
     {.one_of = true},
     "A mesh of gmsh (.msh), on which the state is solved as it is, or a geometry that gmsh reads (.geo, .step, .brep, "
     ".iges). Physical curves on the rim are labels, crack:<name> inside are cracks, physical surfaces regions.",
     "\"plate.msh\""},
    {"domain.side[]", Tables, {.with = "file"}, "A label for a side of the file, which may have none."},
    {"domain.side[].near",
     Pair,
     {.required = true},
     "A point nearer to the side than to any other: a curve of the geometry, or edges that turn by less than 30 "
     "degrees.",
     "[0, 0.5]"},
    {"domain.side[].name", Name, {.required = true}, "Its label.", "\"left\""},

    {"hole[]", Tables, {}, "A hole in the body."},
    {"hole[].name", Name, {.required = true}, "Its boundary is the label hole:<name>.", "\"h1\""},
    {"hole[].circle",
     Table,
     {.one_of = true},
     "A circle; edges follow it, or are the polygon of the same area (mesh.curved).",
     "{ center = [0.5, 1.2], radius = 0.2 }"},
    {"hole[].circle.center", Pair, {.required = true}, "Its center.", "[0.5, 1.2]"},
    {"hole[].circle.radius", Number, {.range = above_zero, .required = true}, "Its radius.", "0.2"},
    {"hole[].ellipse",
     Table,
     {.one_of = true},
     "An ellipse.",
     "{ center = [0, 0], semi_axes = [2, 1], angle_deg = 30 }"},
    {"hole[].ellipse.center", Pair, {.required = true}, "Its center.", "[0, 0]"},
    {"hole[].ellipse.semi_axes", Pair, {.range = above_zero, .required = true}, "Its semi-axes.", "[2, 1]"},
    {"hole[].ellipse.angle_deg", Number, {}, "Angle of the first axis from the x axis.", "30", "0"},
    {"hole[].polygon", PointList, {.one_of = true}, "Its corners, at least 3.", "[[0, 0], [1, 0], [0, 1]]"},
    {"hole[].outline",
     PointList,
     {.one_of = true},
     "Its corners, in order, with arcs between them as in domain.outline.",
     "[[0, 0], { arc_to = [1, 0], center = [0.5, 0] }]"},
    {"hole[].outline[].arc_to", Pair, {.required = true}, "Where the arc ends.", "[1, 0]"},
    {"hole[].outline[].center", Pair, {.required = true}, "Its center, as in domain.outline.", "[0.5, 0]"},
    {"hole[].sides",
     Name | Names,
     {},
     "Another label, or one per edge, instead of hole:<name>.",
     "\"design\"",
     "hole:<name>"},

    {"crack[]",
     Tables,
     {.bare = true},
     "A crack. A piece that cracks cut off must be held by supports, or pressed by the loads onto what holds it. A "
     "crack without a form is the physical curve crack:<name> of domain.file."},
    {"crack[].name", Name, {.required = true}, "Names its files and its rows in results.", "\"c\""},
    {"crack[].path",
     PointList,
     {.one_of = true},
     "A polyline inside the body. It may end on the outline, on a hole or on another crack (within 1e-6 of the body's "
     "size: a branch), and cross other cracks and the borders of regions at 1 degree or more. Ends on a border have no "
     "K. Along sides of a region, from corner to corner, it is an interface.",
     "[[-1, 0], [1, 0]]"},
    {"crack[].arc",
     Table,
     {.one_of = true},
     "An arc of less than a full turn.",
     "{ center = [0, 0], radius = 1, from_deg = 0, to_deg = 90 }"},
    {"crack[].arc.center", Pair, {.required = true}, "Its center.", "[0, 0]"},
    {"crack[].arc.radius", Number, {.range = above_zero, .required = true}, "Its radius.", "1"},
    {"crack[].arc.from_deg", Number, {.required = true}, "The angle at which it begins.", "0"},
    {"crack[].arc.to_deg",
     Number,
     {.required = true},
     "The angle at which it ends; clockwise when it is the smaller one.",
     "90"},
    {"crack[].contact",
     Word,
     {.words = crack_law_words},
     "unilateral: faces do not penetrate and slide freely; open: no condition; bonded: no crack.",
     "\"open\"",
     "\"unilateral\""},
    {"crack[].friction",
     Number,
     {.range = not_negative},
     "Coulomb's coefficient: faces slide when the shear reaches friction times the pressure. For loads that grow in "
     "proportion, or in steps ([[step]]); goes with contact = \"unilateral\".",
     "0.3",
     "0"},
    {"crack[].tresca",
     Number,
     {.range = not_negative},
     "A stress: faces slide when the shear reaches it, whatever the pressure, where they are open too. With friction "
     "both add up. Goes with contact = \"unilateral\".",
     "0.1",
     "0"},
    {"crack[].pressure",
     Formula,
     {},
     "Pressure of a fluid in the crack, without nx and ny: it acts on both faces, open or closed. Contact and friction "
     "take what presses beyond it: sigma_n = -pressure - pressure of contact. Negative: suction. Not with contact = "
     "\"bonded\".",
     "\"0.5 * (1 - x)\"",
     "none"},
    {"crack[].gap",
     Formula,
     {},
     "How far apart the faces are before loading, without nx and ny: they touch where the normal jump is -gap. "
     "Negative: they overlap, a press fit. Goes with contact = \"unilateral\".",
     "\"0.001 * x^2\"",
     "0"},

    {"material", Table, {.required = true}, "What the body is made of."},
    {"material.young",
     Number | Pair,
     {.range = above_zero, .required = true},
     "Young's modulus. [E1, E2]: an orthotropic body in plane stress, with shear and angle; expressions know E1 as E.",
     "1.0"},
    {"material.poisson",
     Number,
     {.range = poisson, .required = true},
     "Poisson's ratio. At 0.5 in plane strain a body with prescribed displacements all around must keep its area. Of "
     "an orthotropic body nu12 = -e22/e11 under s11 alone, any with poisson^2 < E1/E2.",
     "0.3"},
    {"material.shear",
     Number,
     {.range = above_zero},
     "Shear modulus G12 of an orthotropic body. Goes with young = [E1, E2], which needs it.",
     "0.4"},
    {"material.angle",
     Number,
     {},
     "From the x axis to material axis 1, counter-clockwise, in degrees. Goes with young = [E1, E2].",
     "30",
     "0"},
    {"material.thickness",
     Number,
     {.range = above_zero},
     "Of a plate in plane stress. Results are per unit of thickness; with it forces, moments and energies of the "
     "whole plate stand beside them.",
     "5"},
    {"material.yield",
     Number,
     {.range = above_zero},
     "Yield stress. Results then say the reserve against it: this over the largest regular von Mises stress.",
     "250"},
    {"material.toughness",
     Number,
     {.range = above_zero},
     "K_Ic, a stress times the root of a length. Results then say the reserve of every crack tip.",
     "30"},
    {"material.release_rate", Number, {.range = above_zero}, "G_c, a force per length, instead of toughness.", "0.5"},
    {"material.eigenstrain",
     Tensor,
     {},
     "Strain that the body would take without stress, from heat, swelling, a misfit: [xx, yy, xy], in plane strain "
     "also [xx, yy, xy, zz] (zz is 0 where it is left out, and nothing to a plate in plane stress). A temperature T "
     "above that of no stress gives [a*T, a*T, 0, a*T]. Regions have their own.",
     "[\"1e-5*x\", \"1e-5*x\", 0, \"1e-5*x\"]",
     "none"},
    {"material.state",
     Word,
     {.words = plane_states},
     "The plane state, of the regions too.",
     "\"plane stress\"",
     "\"plane strain\""},

    {"region[]",
     Tables,
     {.bare = true},
     "Another material in a part of the body, bonded to it. Its sides may lie on the outline, on holes and on those of "
     "other regions (not with [optimize]), and cracks may cross them. Regions may lie around holes and cracks, and "
     "inside one another: the inner one counts. A region without a form is a physical surface of domain.file, where it "
     "may touch anything."},
    {"region[].name", Name, {.required = true}, "Named in messages and by optimize.frozen.", "\"stiff\""},
    {"region[].circle",
     Table,
     {.one_of = true, .like = "hole[].circle"},
     "A circle.",
     "{ center = [1, 1], radius = 0.1 }"},
    {"region[].ellipse",
     Table,
     {.one_of = true, .like = "hole[].ellipse"},
     "An ellipse.",
     "{ center = [1, 1], semi_axes = [0.2, 0.1] }"},
    {"region[].polygon", PointList, {.one_of = true}, "Its corners, at least 3.", "[[0, 0], [1, 0], [0, 1]]"},
    {"region[].outline",
     PointList,
     {.one_of = true},
     "Its corners, in order, with arcs between them as in domain.outline.",
     "[[0, 0], { arc_to = [1, 0], center = [0.5, 0] }]"},
    {"region[].outline[].arc_to", Pair, {.required = true}, "Where the arc ends.", "[1, 0]"},
    {"region[].outline[].center", Pair, {.required = true}, "Its center, as in domain.outline.", "[0.5, 0]"},
    {"region[].young",
     Number | Pair,
     {.range = above_zero},
     "Young's modulus, or [E1, E2] as in [material]. A region that optimize.frozen names may leave it and poisson out.",
     "10.0"},
    {"region[].poisson", Number, {.range = poisson}, "Poisson's ratio, as in [material].", "0.3"},
    {"region[].shear", Number, {.range = above_zero}, "As in [material], with young = [E1, E2].", "0.4"},
    {"region[].angle", Number, {}, "As in [material], with young = [E1, E2].", "30", "0"},
    {"region[].yield",
     Number,
     {.range = above_zero},
     "As in [material]; without it nothing is said of the region.",
     "250"},
    {"region[].toughness", Number, {.range = above_zero}, "As in [material], of tips in the region.", "30"},
    {"region[].release_rate", Number, {.range = above_zero}, "As in [material], of tips in the region.", "0.5"},
    {"region[].eigenstrain",
     Tensor,
     {},
     "As material.eigenstrain, in the region. A region that has it may leave young and poisson out: it is made of what "
     "the body is made of.",
     "[0.001, 0.001, 0]",
     "none"},

    {"interface[]",
     Tables,
     {},
     "The border between two regions as a crack whose faces touch: a press fit, a ring in a ring, layers. Borders "
     "without an interface are bonded. For solve, map and validate."},
    {"interface[].name",
     Name,
     {.required = true},
     "Names its files and its rows in results, which are those of a crack. "
     "Where two regions meet along several curves, or along lines and arcs in turn, these are name, name.2, ...",
     "\"fit\""},
    {"interface[].between",
     Names,
     {.required = true},
     "Two regions, or a region and \"body\", which is what lies outside all regions.",
     "[\"disc\", \"body\"]"},
    {"interface[].contact",
     Boolean,
     {},
     "true: faces do not penetrate, and slide up to the friction; false: bonded, with what acts across it in the "
     "results.",
     "false",
     "true"},
    {"interface[].friction", Number, {.range = not_negative}, "As crack.friction.", "0.3", "0"},
    {"interface[].gap",
     Formula,
     {},
     "As crack.gap: how far apart the faces are before loading. Negative: a press fit.",
     "-0.001",
     "0"},

    {"boundary[]", Tables, {}, "What acts on a part of the boundary; labels without a condition are free."},
    {"boundary[].on", Text | Names, {.one_of = true}, "A label, or a list of labels.", "\"top\""},
    {"boundary[].at",
     Pair,
     {.one_of = true},
     "Instead of a label a point of the boundary: kerf draws a short edge around it, as of [[load]], on which the "
     "conditions of this table act, and those of the side that it is a piece of.",
     "[2, 0]"},
    {"boundary[].width",
     Number,
     {.range = above_zero, .with = "at"},
     "The length of that edge.",
     "0.01",
     "1/1000 of the body's diagonal"},
    {"boundary[].name", Name, {.with = "at"}, "Its label.", "\"roller\"", "support-1, support-2, ..."},
    {"boundary[].traction", Vector, {}, "Force per length.", "[0, \"1 + x\"]"},
    {"boundary[].pressure", Formula, {}, "Traction -p n.", "0.5"},
    {"boundary[].displacement", Vector, {}, "Both components of the displacement.", "[0, 0]"},
    {"boundary[].displacement_x",
     Formula,
     {},
     "One component alone: a roller. It may carry a traction in its free component.",
     "0"},
    {"boundary[].displacement_y", Formula, {}, "The same for y.", "0"},
    {"boundary[].displacement_normal", Formula, {}, "The same for the component along the outward normal.", "0"},
    {"boundary[].symmetry",
     Boolean,
     {.with = "on"},
     "The body is one half of a whole that is its own mirror image in these straight sides: no normal displacement and "
     "no shear on them. Where such a side ends and a free one goes on straight, a crack in the plane has its tip, and "
     "gets K_I, G and T of the whole body.",
     "true"},

    {"load[]",
     Tables,
     {},
     "A force at a point of the boundary, on a short edge that kerf draws there. The loads of [[load_case]] act on "
     "such "
     "edges by their names."},
    {"load[].at",
     Pair,
     {.required = true},
     "The middle of the edge: a point of the outline or of a hole, half the width or more from corners. At a corner "
     "with "
     "a plane of symmetry it begins there, and half of its width is drawn.",
     "[5, 1]"},
    {"load[].force",
     Vector,
     {},
     "The force on the body that is drawn, per thickness, spread evenly. Needed, but for a load that load cases name.",
     "[0, -100]"},
    {"load[].width",
     Number,
     {.range = above_zero},
     "The length of the edge. Results say what half of it would change.",
     "0.01",
     "1/1000 of the body's diagonal"},
    {"load[].name", Name, {}, "The label of the edge.", "\"punch\"", "load-1, load-2, ..."},

    {"body", Table, {}, "What acts inside the body."},
    {"body.force", Vector, {.required = true}, "Force per area, without nx and ny.", "[0, -1]"},

    {"define", Formulas, {}, "Named subexpressions, in order; each must be used.", "r1 = \"sqrt((x-1)^2 + y^2)\""},

    {"mesh", Table, {}, "The mesh of triangles."},
    {"mesh.size",
     Number,
     {.range = above_zero},
     "Target edge length.",
     "0.1",
     "1/40 of the body's diagonal; of a mesh from a file its mean"},
    {"mesh.crack_tip_size",
     Number,
     {.range = above_zero},
     "Edge length at crack tips. Small is cheap: a factor of 10 costs about 10 % more triangles. A tip with less than "
     "two of them to the next thing drawn gets a twentieth of that.",
     "0.01",
     "size/100"},
    {"mesh.min_angle",
     Number,
     {.range = {0, 30}},
     "Least angle in degrees, kept wherever the drawing's own angles allow.",
     "20",
     "25"},
    {"mesh.refine",
     Whole,
     {.range = {0, 10}},
     "Divides every triangle of the mesh into four similar ones, so many times; for solve and map. The middles of "
     "curved edges go onto their arcs. With adapt that of every round is divided. On several processes (backend = "
     "\"petsc\") each of them divides its own part, and none has the whole.",
     "2",
     "0"},
    {"mesh.curved",
     Word | Boolean,
     {.words = curved_words},
     "Whether edges along arcs, circles and ellipses follow them; then stresses converge at the order of the element "
     "there. auto: wherever the job can; else they are chords, and a note says why. true goes with bdms and afw, in "
     "solve, map and validate. Intervals are those of the body then, and estimates; with chords of the polygon.",
     "false",
     "\"auto\""},
    {"mesh.mesher",
     Word,
     {.words = mesher_words},
     "Who meshes a geometry of domain.file: kerf its outline, or gmsh, whose mesh is kept as it is.",
     "\"gmsh\"",
     "\"kerf\""},
    {"mesh.adapt",
     Table,
     {},
     "Solve, estimate, mesh anew, until the error is reached, the mesh is large, or nothing is gained any more. The "
     "first mesh is that of size, which stays the coarsest. Not for p1 and p2.",
     "{ error = 1e-3 }"},
    {"mesh.adapt.error",
     Number,
     {.range = above_zero, .required = true},
     "Wanted estimated relative error of the stress; with of, wanted relative half width of the interval.",
     "1e-3"},
    {"mesh.adapt.max_triangles",
     Whole,
     {.range = {1, 20000000}},
     "Ends the refinement; the last mesh may have more.",
     "50000",
     "200000"},
    {"mesh.adapt.of",
     Word,
     {.words = goal_words},
     "Refine for this quantity, until half the width of its guaranteed interval is error times the quantity. What it "
     "takes is what [bounds] takes.",
     "\"K_I\"",
     "the stress everywhere"},
    {"mesh.adapt.crack", Text, {}, "Of K_I, K_II and G: the name of a straight open crack.", "\"c\""},
    {"mesh.adapt.tip", Word, {.words = path_ends}, "The end of its path.", "\"end\""},
    {"mesh.adapt.at", Pair, {}, "Of stresses and the topological derivative: where.", "[0.5, 0.5]"},

    {"solver", Table, {}, "How the state is computed."},
    {"solver.element",
     Word,
     {.words = element_names},
     "Which finite element. bdms suits nearly everything. The others are there to compare with: bdms-c has a "
     "continuous "
     "rotation, arnold-winther-c a stress that is continuous at vertices, arnold-winther-nc is nonconforming, p1 and "
     "p2 "
     "are the common elements for displacements.",
     "\"afw\"",
     "\"bdms\""},
    {"solver.degree",
     Whole,
     {.range = {1, 4}},
     "Of bdms and afw; the others have none but 1. Where it is not given, the iterations of [optimize] take 1.",
     "3",
     "2"},
    {"solver.contact",
     Word,
     {.words = contact_method_words},
     "How contact is solved. All give the same answer; the last two are there to compare with.",
     "\"uzawa\"",
     "\"dual-qp\""},
    {"solver.backend",
     Word,
     {.words = backend_words},
     "umfpack solves the whole system at once, without condensing it, and contact in its own way, whatever contact "
     "says. "
     "Slow; for checks. petsc: the processes of mpiexec -n N kerf solve CASE solve together, a part of "
     "the body each, for kerf built with PETSc; mesh.refine divides the parts, which none has as a whole. One process "
     "solves as cholmod does.",
     "\"petsc\"",
     "\"cholmod\""},
    {"solver.precision",
     Word,
     {.words = precision_words},
     "In which the factor is kept, which is most of the memory; all is computed in double precision. single takes half "
     "of it, and a few steps of conjugate gradients for each solve, to the same residual; where it does not serve "
     "(bodies thousands of times as long as wide) it is double, with a note. auto: double, or single where double is "
     "more than the memory that there is or --max-memory allows. The loops of optimizations keep double. On "
     "several processes it is that of the factor of each part, and auto is double.",
     "\"single\"",
     "\"auto\""},
    {"solver.petsc",
     Text,
     {},
     "With backend = \"petsc\": options of PETSc's KSP, which drives all solves in parts, as on a command line: "
     "-ksp_*, "
     "-pc_*, -sub_*, -mg_levels_*, -mg_coarse_*, -mat_mumps_icntl_*, -mat_mumps_cntl_* with numbers and names, "
     "-log_view, -options_left. -pc_type: kerf, its own BDDC on what parts share; bddc and nn, PETSc's on the system "
     "of "
     "the parts; or any that takes one sparse matrix, such as cholesky (MUMPS) or gamg. Options behind -- on the "
     "command "
     "line and in PETSC_OPTIONS go before these. What PETSc has no use for is an error.",
     "\"-ksp_rtol 1e-12 -ksp_monitor\"",
     "-ksp_type cg -pc_type kerf, to 1e-10 of the energy"},

    {"functional", Table, {}, "The number of interest, J: what a map differentiates and an optimization makes small."},
    {"functional.kind",
     Word,
     {.words = functional_kinds, .required = true},
     "Which functional; each kind takes its own keys.",
     "\"compliance\"",
     "\"energy\" without the table"},
    {"functional.on",
     Text | Names,
     {.with = "boundary_tracking|displacement|misfit|worst_edge_crack", .required = true},
     "A label or a list of labels; of a misfit one label without a support.",
     "\"top\""},
    {"functional.crack",
     Text,
     {.with = "energy_release_rate|crack_opening|crack_pressure", .required = true},
     "The name of a crack with faces; of crack_pressure one with contact = \"unilateral\".",
     "\"c\""},
    {"functional.tip",
     Word,
     {.words = path_ends, .with = "energy_release_rate", .required = true},
     "The end of the crack's path where G is.",
     "\"end\""},
    {"functional.target",
     Vector | Formula,
     {.with = "displacement_tracking|boundary_tracking|crack_pressure", .required = true},
     "A displacement, a pair; of crack_pressure a pressure, one value.",
     "[0, \"x\"]"},
    {"functional.direction",
     Vector,
     {.with = "displacement", .required = true},
     "What the displacement is multiplied with.",
     "[0, 1]"},
    {"functional.measured",
     Vector | Text,
     {.with = "misfit", .required = true},
     "Measured displacements: two expressions, \"synthetic\", or a file with the columns x,y,u_x,u_y.",
     "\"data.csv\""},
    {"functional.p",
     Number,
     {.range = {2, 100}, .with = "stress_power|stress_pnorm|worst_edge_crack", .required = true},
     "The power of the von Mises stress, or of K.",
     "4"},
    {"functional.length",
     Number,
     {.range = above_zero, .with = "worst_edge_crack", .required = true},
     "The length of the cracks.",
     "0.5"},
    {"functional.ring",
     Pair,
     {.range = above_zero, .with = "energy_release_rate"},
     "Inner and outer radius of the ring about the tip that G is integrated over.",
     "[0.06, 0.2]",
     "from the crack's length and what is near"},
    {"functional.weight",
     Formula,
     {.with = "displacement_tracking|boundary_tracking|displacement|stress_power|stress_pnorm|crack_opening|crack_"
              "pressure"},
     "Factor under the integral.",
     "\"x > 1 ? 1 : 0\"",
     "1"},
    {"functional.terms[]",
     Tables,
     {.with = "sum", .required = true, .like = "functional"},
     "Functionals that are added; no sums among them, at most one misfit.",
     "[{ kind = \"compliance\" }, { kind = \"volume\", factor = 100 }]"},
    {"functional.terms[].factor", Number, {}, "Factor of the term, not 0.", "100", "1"},

    {"map", Table, {}, "The map of the topological derivative."},
    {"map.perturbation",
     Word | Table,
     {.words = perturbation_words},
     "What is put into the body at a point. hole: free and circular; clamped_hole: u = 0 on the circle; crack: length "
     "2 eps, in unilateral contact, the worst direction; { young, poisson }: a circular inclusion; { aspect }: a free "
     "elliptic hole of area pi eps^2, the direction with the least T; edge_crack: K of a crack of a given length at "
     "every "
     "place of the boundary instead of T, in edge_cracks.csv and edge_cracks.png.",
     "{ young = 2.0, poisson = 0.3 }",
     "\"hole\""},
    {"map.perturbation.young",
     Number,
     {.range = above_zero, .one_of = true},
     "Young's modulus of an inclusion.",
     "2.0"},
    {"map.perturbation.poisson",
     Number,
     {.range = poisson, .with = "young", .required = true},
     "Its Poisson's ratio.",
     "0.3"},
    {"map.perturbation.aspect", Number, {.range = {1, 100}, .one_of = true}, "Ratio of the axes of an ellipse.", "3"},
    {"map.points",
     PointList,
     {},
     "Candidate points. Of edge_crack: the nearest places of the boundary.",
     "[[0.5, 0.5]]",
     "everywhere in the body"},
    {"map.length",
     Number,
     {.range = above_zero},
     "Of edge_crack, and required there: the length of the crack, as the largest one that an inspection misses.",
     "0.5"},
    {"map.angle",
     Number | Word,
     {.range = {30, 150}, .words = worst_words},
     "Of edge_crack: degrees from the boundary, the body to its left; 90: normal. worst: the largest K.",
     "90",
     "\"worst\""},
    {"map.friction",
     Number,
     {.range = not_negative},
     "Of edge_crack: Coulomb's coefficient of its faces where pressure closes them.",
     "0.3",
     "0"},
    {"map.pressurized",
     Boolean,
     {},
     "Of edge_crack: the pressure on the boundary acts in the crack, too.",
     "true",
     "false"},
    {"map.bounds",
     Boolean,
     {},
     "A lower and an upper value for every value of the map: error bars from a better solution (2 to 6 times the "
     "work), no guarantee. Not for bdms of degree 4.",
     "true",
     "false"},
    {"map.second",
     Boolean,
     {},
     "The second term c2 of the expansion, pi eps^2 (T + c2 eps^2), for every value of the map, and the radius up to "
     "which "
     "the first one is good to 5 %. Free holes and inclusions, energies and functionals linear in the state, one "
     "material.",
     "true",
     "false"},
    {"map.radius",
     Number,
     {.range = above_zero},
     "The radius of the hole that you have in mind. A point is masked where such a hole would come too near to "
     "something: "
     "less than 4 radii to the next boundary, crack, tip, end of contact, other material, end of a support or load, or "
     "to "
     "the ring of the functional. With second, where c2 is known: a radius above valid_radius, too. The value of a "
     "clamped hole is for this radius.",
     "0.01",
     "the smallest of validate.radii, else 0.005 of the body's diagonal"},

    {"inspect",
     Table,
     {},
     "What the edge cracks of [map] do to the life of the part: critical lengths, cycles from map.length to them, "
     "intervals between inspections, per place of the boundary."},
    {"inspect.law", Table, {.required = true, .like = "grow.law"}, "As grow.law; quasi-static: the toughness alone."},
    {"inspect.cycle", Table, {}, "The largest and the least load of a cycle, as factors of the loads of the case."},
    {"inspect.cycle.max", Number, {.range = above_zero}, "The largest.", "1.2", "1"},
    {"inspect.cycle.min", Number, {}, "The least, below max; below 0 faces touch, K is 0.", "0.1", "0"},
    {"inspect.factor", Number, {.range = {1, 1e6}}, "Cycles over those between two inspections.", "3", "2"},

    {"validate", Table, {}, "Is the map right? Holes of several radii are made at some points and compared with it."},
    {"validate.points",
     PointList,
     {},
     "Where. The perturbation is that of [map], the mesh that of mesh.size. Not for peers, bdms-c and other elements "
     "with unknowns at vertices.",
     "[[0.5, 0.8]]",
     "two that see every part of the formula, far from features"},
    {"validate.radii",
     Numbers | Table,
     {.range = above_zero, .required = true},
     "Different radii. Give four or more: the fit has three unknowns. Of edge_crack: lengths of cracks that are drawn "
     "and solved.",
     "{ largest = 0.2, ratio = 0.5, count = 6 }"},
    {"validate.radii.largest", Number, {.range = above_zero, .required = true}, "The first radius.", "0.2"},
    {"validate.radii.ratio",
     Number,
     {.range = {0, 1, true, true}, .required = true},
     "Of each radius to the one before.",
     "0.5"},
    {"validate.radii.count", Whole, {.range = {1, 30}, .required = true}, "How many.", "6"},

    {"grow",
     Table,
     {},
     "Cracks grow from their tips, step by step, for kerf grow and kerf run. Each step is a state with exact contact. "
     "Results: growth.csv, growth.png, grown.toml (the body at the end, which goes on), result.json."},
    {"grow.law",
     Table,
     {.required = true},
     "What makes a crack grow. K and lengths in the units of the case: K_c and the like in stress times the root of a "
     "length."},
    {"grow.law.kind",
     Word,
     {.words = law_words, .required = true},
     "quasi-static: the tip that needs the least load grows at that load, load = K_c/K. The others by fatigue, da/dN: "
     "paris C dK^m; walker C (dK/(1 - R)^(1 - gamma))^m; forman C dK^m/((1 - R) K_c - dK); nasgro with Newman's "
     "closure. dK is that of the kink whose K_I changes most between the two loads of a cycle, solved with contact.",
     "\"paris\""},
    {"grow.law.K_c",
     Number,
     {.range = above_zero},
     "Toughness: of quasi-static growth, forman and nasgro; with the others the crack runs when K reaches it.",
     "30"},
    {"grow.law.anisotropy",
     Text,
     {.with = "quasi-static"},
     "The toughness by direction: G_c in the direction phi (radians, counter-clockwise from x) over that of K_c, a "
     "formula of phi. With the criterion energy it turns the crack, too.",
     "\"1 + 0.5*sin(phi)^2\"",
     "\"1\""},
    {"grow.law.K_IIc",
     Number,
     {.range = above_zero, .with = "quasi-static"},
     "Toughness in shear: a crack grows straight on in its own plane where K_II reaches it at a load at which no kink "
     "has K_c.",
     "60",
     "no growth in shear"},
    {"grow.law.C",
     Number,
     {.range = above_zero, .with = "paris|walker|forman|nasgro", .required = true},
     "Factor.",
     "1e-11"},
    {"grow.law.m",
     Number,
     {.range = above_zero, .with = "paris|walker|forman|nasgro", .required = true},
     "Exponent.",
     "3"},
    {"grow.law.gamma", Number, {.range = {0, 1}, .with = "walker"}, "Of the mean load; 1: none.", "0.5", "1"},
    {"grow.law.threshold",
     Number,
     {.range = not_negative, .with = "paris|walker|forman"},
     "dK up to which a crack rests.",
     "2",
     "0"},
    {"grow.law.p", Number, {.range = not_negative, .with = "nasgro"}, "Exponent at the threshold.", "0.5", "0"},
    {"grow.law.q", Number, {.range = not_negative, .with = "nasgro"}, "Exponent at K_c.", "0.5", "0"},
    {"grow.law.alpha",
     Number,
     {.range = {1, 3}, .with = "nasgro"},
     "Constraint: 1 plane stress, 3 plane strain.",
     "2",
     "1"},
    {"grow.law.flow_ratio",
     Number,
     {.range = {0, 1, false, true}, .with = "nasgro"},
     "Largest stress over flow stress.",
     "0.3",
     "0.3"},
    {"grow.law.dK_0", Number, {.range = not_negative, .with = "nasgro"}, "Threshold at R = 0.", "2", "0"},
    {"grow.law.a_0",
     Number,
     {.range = not_negative, .with = "nasgro"},
     "Length below which the threshold falls.",
     "0.04",
     "0"},
    {"grow.law.C_plus", Number, {.range = not_negative, .with = "nasgro"}, "Threshold at R > 0.", "1", "0"},
    {"grow.law.C_minus", Number, {.range = not_negative, .with = "nasgro"}, "Threshold at R < 0.", "0.1", "0"},
    {"grow.region[]",
     Tables,
     {},
     "Another law for tips in a region. A crack crosses the borders of regions; on a border there is no K, so that a "
     "step is made shorter or longer and ends before it or behind it."},
    {"grow.region[].name", Name, {.required = true}, "Of a [[region]].", "\"weld\""},
    {"grow.region[].law",
     Table,
     {.required = true, .like = "grow.law"},
     "As grow.law, quasi-static if that is.",
     "{ kind = \"quasi-static\", K_c = 20 }"},
    {"grow.criterion",
     Word,
     {.words = growth::criterion_words},
     "The direction. local symmetry: K_II = 0 at the tip that has grown, found on the grown body, so that it does not "
     "depend on the step. energy, hoop stress: of the tip before, by the series of a small kink.",
     "\"energy\"",
     "\"local symmetry\""},
    {"grow.tips", Names, {}, "The tips that may grow, crack:start or crack:end of its path.", "[\"c:end\"]", "all"},
    {"grow.cycle",
     Table,
     {},
     "The largest and the least load of a cycle, as factors of the loads of the case: tractions, displacements, body "
     "forces, pressures in cracks."},
    {"grow.cycle.max", Number, {.range = above_zero}, "The largest.", "1.2", "1"},
    {"grow.cycle.min", Number, {}, "The least, below max; negative: reversed.", "0.1", "0"},
    {"grow.cycle.file",
     Text,
     {},
     "A table with a column load: a history of such factors, which repeats. Its cycles are counted by rainflow; cycles "
     "of results are repetitions of it then.",
     "\"spectrum.csv\""},
    {"grow.step",
     Number,
     {.range = above_zero},
     "By which the fastest tip grows in a step; the others by their rates.",
     "0.5",
     "a tenth of the shortest crack, a fiftieth of the body's diagonal at most"},
    {"grow.tolerance",
     Number,
     {.range = {0, 1, true, true}},
     "Growth is repeated with half the step until the paths, relative to what the cracks have grown by, and the cycles "
     "differ by no more than this from those before: then both have error bars.",
     "0.01",
     "one run, no error bars"},
    {"grow.bounds",
     Boolean,
     {},
     "Intervals of K, G and the energy at every step, of the cycles and of the energy that growth releases, as "
     "[bounds] "
     "gives them: guaranteed for elements bdms and afw without friction where faces are open. Each step costs one or "
     "two "
     "solves more.",
     "true",
     "false"},
    {"grow.stress",
     Number,
     {.range = above_zero},
     "Stress that beta in beta_CRACK_TIP.csv refers to: beta = K/(stress sqrt(pi a)), a the crack's length, half of it "
     "where "
     "both "
     "ends grow.",
     "100",
     "1"},
    {"grow.until", Table, {}, "Where growth ends, whatever comes first."},
    {"grow.until.length", Number, {.range = above_zero}, "A crack is so long, along its path.", "20"},
    {"grow.until.cycles", Number, {.range = above_zero}, "So many cycles.", "1e6"},
    {"grow.until.K", Number, {.range = above_zero}, "dK reaches this.", "50"},
    {"grow.until.steps", Whole, {.range = {1, 100000}}, "So many steps.", "40", "100"},

    {"probe[]", Tables, {}, "Points whose values go to probe_<name>.csv."},
    {"probe[].name", Name, {.required = true}, "Names the file.", "\"line\""},
    {"probe[].points", PointList, {.one_of = true}, "The points.", "[[0, 0.1], [0.5, 0.1]]"},
    {"probe[].from", Pair, {.one_of = true}, "Where a straight row of points begins.", "[0, 0.1]"},
    {"probe[].to", Pair, {.with = "from", .required = true}, "Where it ends.", "[1, 0.1]"},
    {"probe[].count",
     Whole,
     {.range = {2, 1000000}, .with = "from", .required = true},
     "How many points it has.",
     "101"},
    {"probe[].file", Text, {.one_of = true}, "A file with the columns x,y.", "\"points.csv\""},
    {"probe[].bounds",
     Boolean,
     {},
     "Columns s_xx_lower, s_xx_upper, ... and guaranteed, as [bounds] gives at points; 200 points at most. Three "
     "quantities per point.",
     "true",
     "false"},

    {"bounds",
     Table,
     {},
     "Intervals that contain quantities of the exact solution; the result says which are guaranteed, and why others "
     "are "
     "not. One solve by the factor of the state and one pass over the triangles per quantity, where cracks may be in "
     "contact up to eight contact problems. Elements bdms and afw; no friction. Where sides are curved the "
     "interval is that of the body, or with mesh.curved = false that of the polygon of the mesh; neither is called "
     "guaranteed."},
    {"bounds.tips",
     Boolean,
     {},
     "K_I, K_II and G at the tips of cracks that are straight there and have contact = \"open\".",
     "false",
     "true"},
    {"bounds.points",
     PointList,
     {},
     "Stresses here, the von Mises stress, and T for a circular hole or inclusion: of energies, the compliance and "
     "misfits, also where cracks may be in contact, and of what is linear in the displacement where none may. Three "
     "quantities per point and body: the state, the adjoint, the body with measured displacements.",
     "[[0.5, 0.5]]"},
    {"bounds.displacements",
     Text | Names,
     {},
     "Labels: mean displacement u_x, u_y of each. Two quantities per label.",
     "[\"top\"]"},
    {"bounds.reactions",
     Text | Names,
     {},
     "Labels with a support: the force on the body in the directions that it holds, for each. Two quantities per "
     "label.",
     "[\"left\"]"},
    {"bounds.compliance", Boolean, {}, "The work of all loads.", "true", "false"},
    {"bounds.disc[]",
     Tables,
     {},
     "Mean stress and mean strain over a disc inside the body, clear of boundaries, cracks and other materials. Three "
     "quantities."},
    {"bounds.disc[].center", Pair, {.required = true}, "Its center.", "[0.5, 0.5]"},
    {"bounds.disc[].radius", Number, {.range = above_zero, .required = true}, "Its radius.", "0.1"},
    {"bounds.line[]",
     Tables,
     {},
     "Mean stress along a line inside the body: s_nn and s_nt that act across it, n = its direction turned by +90 "
     "degrees, and s_tt along it. It must end before boundaries, cracks and other materials. Three quantities."},
    {"bounds.line[].from", Pair, {.required = true}, "Where it begins.", "[0.2, 0.5]"},
    {"bounds.line[].to", Pair, {.required = true}, "Where it ends.", "[0.8, 0.5]"},

    {"output",
     Table,
     {},
     "Which files are written beside result.json and the tables, and what is found of a state beside its solution: "
     "each "
     "takes time, its own line of time_s."},
    {"output.vtk", Boolean, {}, "Fields for ParaView.", "false", "true"},
    {"output.png", Boolean, {}, "Pictures.", "false", "true"},
    {"output.html", Boolean, {}, "The report, one page.", "false", "true"},
    {"output.estimate",
     Boolean,
     {},
     "The estimated error of the stress; mesh.adapt needs it. Without it nothing says how fine the mesh should be.",
     "false",
     "true"},
    {"output.energy_bounds", Boolean, {}, "The interval that contains the energy.", "false", "true"},
    {"output.tips", Boolean, {}, "K_I, K_II, G and T at the tips of cracks.", "false", "true"},
    {"output.peaks",
     Boolean,
     {},
     "The largest von Mises stress, displacement and pressure in contact, and the notes on large strains. Without "
     "peaks, "
     "vtk, png and html "
     "no field is recovered at corners.",
     "false",
     "true"},
    {"output.margins",
     Boolean,
     {},
     "Margins of the largest von Mises stress, the largest displacement and of K, G and T: the truth is expected "
     "within "
     "value +- margin. It takes another state, of one degree more on the same mesh.",
     "false",
     "true up to 30,000 triangles"},

    {"optimize", Table, {}, "The best body: J of [functional], which must be there, as small as it can be."},
    {"optimize.method",
     Word,
     {.words = optimize_method_words},
     "level-set: any shape, holes appear and merge. The others, of NLopt, move what is drawn by a few numbers; cobyla "
     "without derivatives.",
     "\"mma\"",
     "\"level-set\""},
    {"optimize.volume",
     Table,
     {},
     "A bound or a price of the area. A level set for the compliance alone needs it: without, the full body is best.",
     "{ at_most = 0.4 }"},
    {"optimize.volume.at_most", Number, {.range = {0, 1, true}}, "Share of the area of the body as drawn.", "0.4"},
    {"optimize.volume.penalty", Number, {.range = above_zero}, "J + penalty times area is minimized.", "100"},
    {"optimize.max_iterations",
     Whole,
     {.range = {1, 1000000}},
     "Of the level set; of the NLopt methods evaluations of a design.",
     "60",
     "100"},
    {"optimize.tolerance",
     Number,
     {.range = {1e-12, 0.5}},
     "Relative change of J (level set), residual of the optimality conditions (NLopt).",
     "1e-4",
     "1e-3"},
    {"optimize.starts",
     Whole,
     {.range = {1, 1000}},
     "How many designs to begin with: the given one, and others spread over what is allowed. They are compared on a "
     "coarse mesh; the best goes on. The processes of kerf optimize --processes share them.",
     "8",
     "as many as the method needs; NLopt methods: 1"},
    {"optimize.bound[]",
     Tables,
     {.like = "functional"},
     "A functional that must not exceed a value; no misfit. With load cases the worst of them counts."},
    {"optimize.bound[].at_most",
     Number,
     {.required = true},
     "The value, not 0; positive but of energy, crack_opening and sum.",
     "10"},
    {"optimize.bound[].name", Name, {}, "In messages and tables.", "\"stiffness\"", "its kind"},
    {"optimize.nucleate",
     Table | Boolean,
     {.with = level_set},
     "New holes where the topological derivative says so; false: none.",
     "{ every = 5, fraction = 0.02 }",
     "true"},
    {"optimize.nucleate.every", Whole, {.range = {1, 100000}}, "In every so many iterations.", "10", "5"},
    {"optimize.nucleate.fraction",
     Number,
     {.range = {0, 0.5, true}},
     "At most this share of the area at a time.",
     "0.01",
     "0.02"},
    {"optimize.frozen",
     Names,
     {.with = level_set},
     "[[region]] tables that stay solid. One without young and poisson is no other material, only a mask, and may "
     "touch and leave the outline.",
     "[\"load_pad\"]",
     "nothing"},
    {"optimize.keep_out[]",
     Tables,
     {},
     "A region that stays void; it may reach out of the body. Shares of the area are then those of the body without "
     "it.",
     "{ circle = { center = [1, 1], radius = 0.2 } }"},
    {"optimize.keep_out[].name", Name, {}, "In messages and tables.", "\"spanner\"", "keep_out_1, ..."},
    {"optimize.keep_out[].circle",
     Table,
     {.one_of = true, .like = "hole[].circle"},
     "A circle.",
     "{ center = [1, 1], radius = 0.1 }"},
    {"optimize.keep_out[].ellipse",
     Table,
     {.one_of = true, .like = "hole[].ellipse"},
     "An ellipse.",
     "{ center = [1, 1], semi_axes = [0.2, 0.1] }"},
    {"optimize.keep_out[].polygon",
     PointList,
     {.one_of = true},
     "Its corners, at least 3.",
     "[[0, 0], [1, 0], [0, 1]]"},
    {"optimize.move",
     Word,
     {.words = move_words, .with = level_set},
     "What moves the boundary; fixed-point: of the topological derivative.",
     "\"fixed-point\"",
     "\"shape-gradient\""},
    {"optimize.inner_product",
     Word,
     {.words = inner_product_words, .with = level_set},
     "That smooths the shape gradient.",
     "\"elasticity\"",
     "\"h1\""},
    {"optimize.smoothing",
     Number,
     {.range = above_zero, .with = level_set},
     "Its length.",
     "0.1",
     "from the mesh size"},
    {"optimize.symmetry",
     Table,
     {.with = level_set},
     "The design is its own mirror image about a line. The body as drawn must be so, too; loads need not.",
     "{ x = 1.0 }",
     "none"},
    {"optimize.symmetry.x", Number, {.one_of = true}, "The line x = ...", "1.0"},
    {"optimize.symmetry.y", Number, {.one_of = true}, "The line y = ...", "0.5"},
    {"optimize.symmetry.point", Pair, {.one_of = true}, "A point of the line.", "[0, 0]"},
    {"optimize.symmetry.direction", Pair, {.with = "point", .required = true}, "Along the line, not zero.", "[1, 1]"},
    {"optimize.min_feature",
     Number,
     {.range = above_zero, .with = level_set},
     "Members thinner than this are not wanted, nor gaps without min_gap: the local thickness is measured at the end.",
     "0.05",
     "none"},
    {"optimize.min_gap",
     Number,
     {.range = above_zero, .with = level_set},
     "Gaps narrower than this are not wanted; measured at the end, too.",
     "0.03",
     "none"},
    {"optimize.min_radius",
     Number,
     {.range = above_zero, .with = level_set},
     "Arcs of the finished design are no tighter.",
     "0.02",
     "0.4 of mesh.size"},
    {"optimize.start",
     Table,
     {.with = level_set},
     "Holes, or a design, to begin with.",
     "{ holes = [4, 2], radius = 0.1 }",
     "the full body"},
    {"optimize.start.holes",
     Pair,
     {.range = {1, 1000}, .one_of = true},
     "[columns, rows] of a regular pattern, whole numbers.",
     "[4, 2]"},
    {"optimize.start.random", Whole, {.range = {1, 100000}, .one_of = true}, "How many holes at random places.", "10"},
    {"optimize.start.seed", Whole, {.range = {0, 2147483647}, .with = "random"}, "Of the random places.", "7", "1"},
    {"optimize.start.radius",
     Number,
     {.range = above_zero, .with = "holes|random", .required = true},
     "Of the holes.",
     "0.1"},
    {"optimize.start.design",
     Text,
     {.one_of = true},
     "A case file whose body, inside this one, to go on from, such as the design.toml of an earlier run; relative to "
     "this file.",
     "\"out/earlier/design.toml\""},
    {"optimize.ersatz",
     Number,
     {.range = {1e-9, 0.5}, .with = level_set},
     "Stiffness of a weak phase instead of void, relative to the body's, to compare with.",
     "1e-3",
     "void"},
    {"optimize.min_distance",
     Number,
     {.range = above_zero, .with = methods_of_drawn},
     "Between holes, and from holes to cracks and the outline.",
     "0.05",
     "0"},
    {"optimize.least_squares",
     Boolean | Table,
     {.with = methods_of_drawn},
     "Inverse problems: after the misfit the sum of squares of the readings is minimized, with the uncertainty of what "
     "is "
     "found.",
     "{ noise = 1e-4 }",
     "false"},
    {"optimize.least_squares.noise",
     Number,
     {.range = above_zero},
     "Standard deviation of every measured component, a length.",
     "1e-4",
     "that of [synthetic], or estimated"},
    {"optimize.defects",
     Table,
     {.with = methods_of_drawn},
     "Inverse problems: how many there are of what is drawn is read off the readings, in every mixture of several "
     "things; goes with start = \"map\", "
     "and asks for least_squares.",
     "{ at_most = 5 }",
     "as many as are drawn"},
    {"optimize.defects.at_most",
     Whole,
     {.range = {1, 20}, .required = true},
     "No more than these are tried; 5 with count alone.",
     "5"},
    {"optimize.hole[]",
     Tables,
     {.with = methods_of_drawn},
     "A hole that is moved: a box [low, high] per number; a number alone is fixed."},
    {"optimize.hole[].name", Name, {}, "In messages and tables.", "\"h\"", "hole_1, ..."},
    {"optimize.hole[].count",
     Word,
     {.words = counted},
     "Inverse problems: auto: how many there are, 0 to defects.at_most, and of which of the kinds drawn, is read off "
     "the readings.",
     "\"auto\"",
     "one"},
    {"optimize.hole[].circle",
     Table,
     {.one_of = true},
     "A circle.",
     "{ center = [[0.2, 0.8], [0.2, 0.8]], radius = [0.02, 0.15] }"},
    {"optimize.hole[].circle.center", BoxPair, {.required = true}, "Its center.", "[[0.2, 0.8], 0.5]"},
    {"optimize.hole[].circle.radius", Box, {.range = above_zero, .required = true}, "Its radius.", "[0.02, 0.15]"},
    {"optimize.hole[].ellipse",
     Table,
     {.one_of = true},
     "An ellipse.",
     "{ center = [0.5, 0.5], semi_axes = [[0.1, 0.3], [0.1, 0.3]] }"},
    {"optimize.hole[].ellipse.center", BoxPair, {.required = true}, "Its center.", "[[0.2, 0.8], 0.5]"},
    {"optimize.hole[].ellipse.semi_axes",
     BoxPair,
     {.range = above_zero, .required = true},
     "Its semi-axes.",
     "[[0.1, 0.3], [0.1, 0.3]]"},
    {"optimize.hole[].ellipse.angle_deg", Box, {}, "Angle of the first axis from the x axis.", "[-45, 45]", "0"},
    {"optimize.hole[].spline",
     Table,
     {.one_of = true},
     "A closed cubic B-spline.",
     "{ points = [[[0.2, 0.4], [0.2, 0.4]], [[0.6, 0.8], [0.2, 0.4]], [[0.6, 0.8], [0.6, 0.8]], [[0.2, 0.4], [0.6, "
     "0.8]]] }"},
    {"optimize.hole[].spline.points",
     BoxPairs,
     {.required = true},
     "Its control points, 4 or more, counter-clockwise.",
     "[[[0.2, 0.4], [0.2, 0.4]], [[0.6, 0.8], [0.2, 0.4]], [[0.6, 0.8], [0.6, 0.8]], [[0.2, 0.4], [0.6, 0.8]]]"},
    {"optimize.hole[].start",
     Table | Word,
     {.words = from_map},
     "Where the numbers begin, all or some. map: read off topological derivatives on the body without the design.",
     "{ center = [0.5, 0.5], radius = 0.1 }",
     "the middle of the boxes"},
    {"optimize.hole[].start.center",
     Pair,
     {.with = "circle|ellipse"},
     "The center; of a spline, with radius, that of a circle.",
     "[0.5, 0.5]"},
    {"optimize.hole[].start.radius", Number, {.with = "circle|center"}, "The radius.", "0.1"},
    {"optimize.hole[].start.semi_axes", Pair, {.with = "ellipse"}, "The semi-axes.", "[0.2, 0.1]"},
    {"optimize.hole[].start.angle_deg", Number, {.with = "ellipse"}, "The angle.", "10"},
    {"optimize.hole[].start.points",
     PointList,
     {.with = "spline"},
     "All control points, instead of center and radius.",
     "[[0.3, 0.3], [0.7, 0.3], [0.7, 0.7], [0.3, 0.7]]"},
    {"optimize.crack[]", Tables, {.with = methods_of_drawn}, "A crack that is moved."},
    {"optimize.crack[].name", Name, {}, "In messages and tables.", "\"c\"", "crack_1, ..."},
    {"optimize.crack[].count", Word, {.words = counted}, "As of [[optimize.hole]].", "\"auto\"", "one"},
    {"optimize.crack[].path",
     BoxPairs,
     {.required = true},
     "Its points, 2 or more.",
     "[[[0.2, 0.4], 0.5], [[0.6, 0.8], 0.5]]"},
    {"optimize.crack[].contact", Word, {.words = drawn_laws}, "As of [[crack]].", "\"open\"", "\"unilateral\""},
    {"optimize.crack[].start",
     Table | Word,
     {.words = from_map},
     "As of [[optimize.hole]].",
     "{ path = [[0.3, 0.5], [0.7, 0.5]] }",
     "the middle of the boxes"},
    {"optimize.crack[].start.path", PointList, {.required = true}, "All its points.", "[[0.3, 0.5], [0.7, 0.5]]"},
    {"optimize.region[]", Tables, {.with = methods_of_drawn}, "An inclusion that is moved."},
    {"optimize.region[].name", Name, {}, "In messages and tables.", "\"r\"", "region_1, ..."},
    {"optimize.region[].count", Word, {.words = counted}, "As of [[optimize.hole]].", "\"auto\"", "one"},
    {"optimize.region[].circle",
     Table,
     {.required = true, .like = "optimize.hole[].circle"},
     "A circle.",
     "{ center = [[0.2, 0.8], [0.2, 0.8]], radius = [0.02, 0.15] }"},
    {"optimize.region[].young", Box, {.range = above_zero, .required = true}, "Young's modulus.", "[2, 20]"},
    {"optimize.region[].poisson",
     Number,
     {.range = poisson, .required = true},
     "Poisson's ratio, which is fixed.",
     "0.3"},
    {"optimize.region[].start",
     Table | Word,
     {.words = from_map},
     "As of [[optimize.hole]].",
     "{ center = [0.5, 0.5], radius = 0.1, young = 5 }",
     "the middle of the boxes"},
    {"optimize.region[].start.center", Pair, {}, "The center.", "[0.5, 0.5]"},
    {"optimize.region[].start.radius", Number, {}, "The radius.", "0.1"},
    {"optimize.region[].start.young", Number, {}, "Young's modulus.", "5"},

    {"load_case[]",
     Tables,
     {},
     "Loads that act together; goes with [optimize]. With load cases all loads belong to them. J is the sum of weight "
     "times the functional of each."},
    {"load_case[].name", Name, {.required = true}, "In messages and tables.", "\"wind\""},
    {"load_case[].weight", Number, {.range = above_zero}, "Its weight in J.", "2", "1"},
    {"load_case[].boundary[]", Tables, {}, "A load on a part of the boundary, as in [[boundary]]."},
    {"load_case[].boundary[].on", Text | Names, {.required = true}, "A label, or a list of labels.", "\"top\""},
    {"load_case[].boundary[].traction", Vector, {}, "Force per length.", "[0, -1]"},
    {"load_case[].boundary[].pressure", Formula, {}, "Traction -p n.", "0.5"},
    {"load_case[].body", Table, {.like = "body"}, "What acts inside the body.", "{ force = [0, -1] }"},

    {"step[]",
     Tables,
     {},
     "A step of the history of the loads, for friction, which depends on it: slip is remembered from step to step. The "
     "body is unloaded before the first; [define] says what its names are then. With kerf solve alone."},
    {"step[].name", Name, {.required = true}, "In messages and tables.", "\"unload\""},
    {"step[].define",
     Formulas,
     {.required = true},
     "New values of numbers in [define], which loads, pressures in cracks, prescribed displacements and eigenstrains "
     "use; the others stay what they were.",
     "{ shear = 0.3 }"},
    {"step[].substeps",
     Number,
     {.range = {1, 1000}},
     "Parts of the step, with values on the straight line.",
     "10",
     "1"},

    {"synthetic",
     Table,
     {},
     "The true body that measurements are made up from: the one drawn, and at least one hole, crack or region; goes "
     "with measured = \"synthetic\"."},
    {"synthetic.hole[]", Tables, {.like = "hole[]"}, "As [[hole]]."},
    {"synthetic.crack[]", Tables, {.like = "crack[]"}, "As [[crack]]."},
    {"synthetic.region[]", Tables, {.like = "region[]"}, "As [[region]]."},
    {"synthetic.element",
     Word,
     {.words = element_names},
     "Other than solver.element or of another degree (no inverse crime).",
     "\"p2\"",
     "\"afw\" of degree 2, or \"bdms\""},
    {"synthetic.degree", Whole, {.range = {1, 4}}, "Its degree.", "3", "1 with element, else 2"},
    {"synthetic.size", Number, {.range = above_zero}, "Target edge length of its mesh.", "0.02", "0.7 times mesh.size"},
    {"synthetic.crack_tip_size",
     Number,
     {.range = above_zero},
     "The same at crack tips.",
     "0.001",
     "0.7 times mesh.crack_tip_size"},
    {"synthetic.noise",
     Number,
     {.range = {0, 1}},
     "Standard deviation relative to the root mean square of the displacements.",
     "0.05",
     "0"},
    {"synthetic.spacing", Number, {.range = above_zero}, "Of the sensors along the label.", "0.05", "mesh.size"},
    {"synthetic.seed", Whole, {.range = {0, 2147483647}}, "Of the noise.", "7", "1"}};

View without_entry(View path) {
  while (path.ends_with("[]")) path.remove_suffix(2);
  return path;
}

/// "" of "mesh", "mesh" of "mesh.size".
const Key* row(View path) {
  const auto found = std::find_if(std::begin(rows), std::end(rows), [&](const Key& key) { return key.path == path; });
  return found == std::end(rows) ? nullptr : found;
}

/// The path with a table that is like another one replaced by the other, the innermost first; empty: there is none.
std::string alike(View path) {
  for (View table = parent(path); !table.empty(); table = parent(table))
    if (const Key* key = row(table); key && !key->rules.like.empty())
      return std::string(key->rules.like) + std::string(path.substr(table.size()));
  return {};
}

bool list_contains(View list, View word) {
  while (!list.empty()) {
    const std::size_t end = std::min(list.find('|'), list.size());
    if (list.substr(0, end) == word) return true;
    list.remove_prefix(std::min(end + 1, list.size()));
  }
  return false;
}

}  // namespace

View parent(View path) {
  const std::size_t dot = path.rfind('.');
  return dot == View::npos ? View() : path.substr(0, dot);
}

std::span<const Key> all_keys() {
  return rows;
}

std::string_view name(const Key& key) {
  const View path = without_entry(key.path);
  return path.substr(path.rfind('.') + 1);  // npos + 1 is 0
}

const Key* find_key(std::string_view path) {
  if (const Key* key = row(path)) return key;
  if (const std::string other = alike(path); !other.empty()) return find_key(other);
  return path.ends_with("[]") ? find_key(path.substr(0, path.size() - 2)) : nullptr;
}

std::vector<const Key*> keys_in(std::string_view table, std::string_view variant) {
  std::vector<const Key*> keys;
  const Key* whole = row(table);
  if (whole && !whole->rules.like.empty()) keys = keys_in(whole->rules.like);
  if (const std::string other = alike(table); !whole && !other.empty()) keys = keys_in(other);
  for (const Key& key : rows)
    if (parent(key.path) == table) keys.push_back(&key);
  if (!variant.empty())
    std::erase_if(keys, [&](const Key* key) {
      const bool always = key->rules.with.empty() && !key->rules.one_of;
      return !always && name(*key) != variant && !list_contains(key->rules.with, variant);
    });
  return keys;
}

std::string in_words(const KeyRange& r) {
  const bool below = r.most<infinity, above = r.least> - infinity;
  if (r.least == 0 && r.above && !below) return "positive";
  if (r.least == 0 && !r.above && !below) return "not negative";
  if (above && below && r.above == r.below)
    return fmt::format("between {} and {}{}", r.least, r.most, r.above ? ", both excluded" : "");
  if (above && below && r.least == 0) return fmt::format("positive, at most {}", r.most);
  if (above && below && r.above) return fmt::format("above {} and at most {}", r.least, r.most);
  return "";
}

}  // namespace kerf

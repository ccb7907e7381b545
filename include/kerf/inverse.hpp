#pragma once
// Inverse problems: measurements that are made up, starts read off the topological derivative, what was found beside
// what is true.

#include "kerf/optimize.hpp"

#include <span>
#include <vector>

namespace kerf {

/// The body that measurements are made up from: an inverse problem whose answer is known. Another mesh and another
/// element than those of the search: no inverse crime.
struct Synthetic {
  Shape true_shape;  // what the case draws, and what it looks for
  Scene true_scene;  // of it
  Element element = afw(1);
  Sizing sizing;
  double noise = 0;    // standard deviation of each component at each sensor, relative to the root mean square of all
  double spacing = 0;  // of the sensors along the boundary; 0: the edge length of the mesh
  unsigned seed = 1;
  Index label = none;  // where they are measured
};

/// What sensors read, and the field between them.
struct Measurement {
  std::vector<Vec2> at, exact, displacement;  // per sensor: place, u of the true body, the same with noise
  std::vector<bool> known;                    // per sensor: without noise
  double scale = 0;                           // root mean square of the components of `exact`
  BoundaryField field;
};

/// Sensors lie at equal distances from corner to corner of the label, both corners included. Between them the field is
/// the cubic through the next four (Catmull and Rom; parabolas at corners), so that noise is limited to the band that
/// the sensors resolve: noise at every point would have an infinite energy, and the misfit measures energies. Noise is
/// normal, independent from sensor to sensor, and none where the label ends at a support, which is known. It comes from
/// the seed by a generator of our own, the same numbers on every machine.
/// Throws Error(Usage) for an unknown label or element, Error(Numerics) when the true body cannot be solved.
Measurement measure(const Synthetic& s, int threads = 1);

/// The functional with these data for all its misfits on the label.
Functional with_measured(Functional j, Index label, const BoundaryField& measured);

/// Independent normal numbers with deviation 1: Box and Muller on mt19937, rounded to 1e-9 so that the last digit of
/// somebody's logarithm does not show.
std::vector<double> normal_numbers(unsigned seed, std::size_t count);

/// Something small that explains a part of the data.
struct Guess {
  std::size_t drawn = 0;  // number in the design
  Vec2 at = Vec2::Zero();
  double size = 0;   // radius, half the length of a crack
  double angle = 0;  // radians, of a crack
  double young = 0;  // of an inclusion
};

/// "hole 'a' at (0.62, 0.57), radius 0.08".
std::string in_words(const Guess& g, const Design& design);

struct InitialGuess {
  Design design;  // with the starts filled in
  std::vector<Guess> guesses;
  double explained = 0;  // part of the data: 1 - |u_m - u(guess)|^2 / |u_m - u|^2 in the hats; NaN: no misfit
  int solves = 0;        // states and linear ones
};

/// With a misfit: the data are the differences u_m - u between the measured displacements and those of the body without
/// what is looked for, b_k = int phi_k . (u_m - u), phi_k hats along the label, normed in L2, so that independent noise
/// at the sensors is independent and equal in all b. A hole of area a at x changes reading k by a T_k(x), T_k its
/// topological derivative. The guess minimizes
///   |b - sum_i a_i T(x_i)|^2
/// over places, angles and areas a_i = pi size_i^2 within the boxes of the design: the expansion of the misfit to
/// second order in the areas. Best places first among a grid of candidates (pairs together where there are few enough),
/// then between them. The first-order part alone, which is the map of the misfit, does not tell how deep a hole lies:
/// the stresses that it is made of are largest at the boundary.
///
/// Then the guess is drawn and solved for, what the expansion missed is taken off b, and the fit repeated as long as
/// that explains more: holes are not small, and feel each other.
///
/// Without a misfit: the most negative values of the map of the objective, apart from one another and as far from
/// everything else as their size needs, which stays the start's.
///
/// `clear`: what must remain between two of them and to everything else. Throws Error(Usage) where nothing of the boxes
/// lies in the body, and like analyze and responses.
InitialGuess initial_guess(const Problem& problem, const Design& design, double clear);

/// Whether there is anything to be read off a map.
bool wants_map(const Design& design);

/// One thing of the design and the nearest true one of its kind (each true one once).
struct Identified {
  std::string name, truth;       // "hole 'a'", "hole 'true'"; truth empty: there are more in the design than in truth
  Eigen::VectorXd found, exact;  // center and radius (of a circle of the same area; inclusions: and Young's modulus);
                                 // of a crack its ends, the true ones in the order that is nearer
  double position_error = 0;     // of the center; of a crack the larger of its ends
  double size_error = 0;         // radius, length: found less exact
};

/// `x`: variables of the design. What the true body has and the frame has not: the last ones of its holes, cracks,
/// regions.
std::vector<Identified> identified(const Design& design, const Eigen::VectorXd& x, const Problem& problem,
                                   const Synthetic& truth);

/// "hole 'a': center (0.621, 0.569), radius 0.0801; true: ..., off by 0.0012 and +0.0001".
std::string in_words(const Identified& i);

// Least squares of the readings.

/// Numbers to be met: displacements of points of a labeled part of the boundary.
struct Readings {
  Index label = none;
  std::vector<Vec2> at, displacement;
  double noise = 0;  // standard deviation of every component; 0: not known
};
/// Those of sensors that are not exact.
Readings readings_of(const Measurement& m, const Synthetic& s);

/// 95 % of such ellipses hold the true place [theory: I.6].
struct UncertaintyEllipse {
  std::string name;  // "hole 'a'", "crack 'c', point 2"
  Vec2 at = Vec2::Zero(), semi_axes = Vec2::Zero();
  double angle = 0;  // radians, of the first axis
};

/// A combination of the unknowns that is independent of the other ones in what the readings tell of it. Every unknown
/// is measured in its box, so that the combination of a point anywhere in the boxes has the deviation 1/sqrt(12).
struct Combination {
  Eigen::VectorXd weights;      // of all variables, of length 1
  double deviation = infinity;  // in boxes; NaN: not known
  bool fixed = false;           // it is less than that of a point anywhere in the boxes
};

/// What the readings say of the model, with what evidence [theory: I.8, I.9].
enum class FitVerdict {
  Explained,    // chi2 is what the noise makes it
  Untested,     // the noise is not known, or no reading is left to test anything by
  Coarse,       // chi2 is too large, and by no more than the mesh may be to blame for
  Unexplained,  // chi2 is too large, on the finer mesh, too, even without what that mesh has changed
  Undetermined  // the readings leave combinations of the unknowns open
};
inline constexpr std::array<std::string_view, 5> fit_verdict_words{
    "explained", "untested", "the mesh is too coarse for the noise", "the model does not explain the readings",
    "not enough readings"};
constexpr std::string_view word(FitVerdict verdict) {
  return fit_verdict_words[static_cast<std::size_t>(verdict)];
}

/// chi2 = sum of |u(x_i) - m_i|^2 over the sensors, and where it is least.
struct LeastSquares {
  Eigen::VectorXd variables;
  int readings = 0;               // components
  double start = nan, end = nan;  // chi2, each on a mesh of its own
  double noise = 0;               // given, or sqrt(end / (readings - variables that are free)); NaN: not known
  bool estimated = false;         // the latter
  int steps = 0, state_solves = 0;
  double optimality = nan;                   // largest cosine between the misfit and a column of its derivative
  Eigen::MatrixXd covariance;                // noise^2 (J'J)^-1; zero for variables that are fixed or at a bound
  std::vector<UncertaintyEllipse> ellipses;  // of places that the readings fix, where the model is not refuted
  std::string stopped;                       // why it ended, in words
  double gain = nan;   // by which a step within the boxes could lower chi2, over the variance of the noise
  double finer = nan;  // chi2 on the finer mesh, less what the variables could lower it by there
  double mesh = nan;   // the square of what that mesh changes of the misfit, less the same
  std::array<double, 2> expected{nan, nan};    // 95 % of chi2 by the noise alone lie between, over the variance
  double most = nan;                           // 99.9 % lie below, over the variance
  std::vector<Combination> combinations = {};  // as many as there are unknowns, the surest first
  FitVerdict verdict = FitVerdict::Untested;
};

/// How many combinations the readings fix.
int rank_of(const LeastSquares& fit);
/// The deviation of a variable; NaN: a number would claim more than is known, since the model is refuted, the readings
/// do not fix the variable, or it is fixed or at a bound.
double deviation_of(const LeastSquares& fit, Eigen::Index variable);
/// Whether the readings tell of a variable more than its box does.
bool is_fixed(const LeastSquares& fit, Eigen::Index variable);
/// "0.71 h.x - 0.7 h.radius": the weights in boxes, without the small ones.
std::string in_words(const Combination& c, const std::vector<std::string>& names);

/// Judges the result of an optimization whose design is that of the fit: the design on the finer mesh, the ending and
/// why. "optimal" only where the sum is least, the readings fix all unknowns, and chi2 does not refute the model.
void judge_fit(const Problem& problem, const OptimizeRequest& request, const LeastSquares& fit, OptimizeResult& result);

/// Levenberg and Marquardt from `start` over the free variables of the design, within its bounds and the constraints
/// that keep designs meshable [theory: I.4]. Derivatives are exact: difference quotients find the space that the
/// columns of the derivative span, adjoints their components in it [theory: I.5]. Never ends with a larger sum than it
/// began with. Faces of cracks that touch stay in touch in derivatives. Throws Error(Usage) for elements without
/// derivatives, Error(Geometry) or Error(Numerics) when the start cannot be meshed or solved.
LeastSquares least_squares(const Problem& problem, const OptimizeRequest& request, const Eigen::VectorXd& start,
                           const Readings& readings);

/// "sum of squares 0.012 to 3.4e-05 over 242 readings, noise 0.00051 (estimated)", and a line per variable with its
/// deviation; `names` of the variables.
std::vector<std::string> in_words(const LeastSquares& fit, const std::vector<std::string>& names);

/// The fit with so many of each thing that the design draws.
struct Counted {
  int count = 0;             // of all together
  std::vector<int> of;       // of each
  Design design;             // its starts are what was found
  LeastSquares fit = {};     // of none: no variables
  int variables = 0;         // that are free
  double criterion = nan;    // of Bayes and Schwarz [theory: I.7]
  double aicc = nan;         // of Akaike, corrected for few readings [theory: I.10]
  std::string failure = {};  // why it is not chosen; empty mostly
};

/// How many are there, and of which kind: fits with 0, 1, ... at_most copies of what the design draws, in every mixture
/// of its things, each begun from the map (initial_guess), until two numbers in a row have not been better. `chosen` in
/// `tried` has the least criterion of the least number that no larger one beats by 6. A fit with a phantom is not
/// chosen: a thing that is smaller than twice the deviation of its size, or as small as its box allows; nor one with as
/// many variables as readings.
struct Count {
  std::vector<Counted> tried;
  std::size_t chosen = 0;
  std::vector<std::string> things;  // names of what is counted
};
Count count_defects(const Problem& problem, const OptimizeRequest& request, const Readings& readings, int at_most);
/// "2 defects by the criterion of Bayes and Schwarz: 0: 812.4, 1: 130.2, 2: 101.0, ...".
std::string in_words(const Count& count);
/// A line for every fit: what, how many variables, chi2 per reading or the noise that it would take, both criteria.
std::vector<std::string> table_in_words(const Count& count);
/// So many copies of every thing that the design draws, named "<name>_1", ...; one keeps its name.
Design copies(const Design& design, const std::vector<int>& counts);

}  // namespace kerf

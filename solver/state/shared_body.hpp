#pragma once
// What SharedBody (solver/divided_body.hpp) has inside.

#include "solver/divided_body.hpp"
#include "solver/state/guess.hpp"
#include "solver/state/solve.hpp"
#include "solver/system/elementwise.hpp"
#include "solver/system/penalty.hpp"

#include <map>
#include <optional>

namespace kerf {

/// The system of all processes for one set of rows in contact that are held; those that move are rows as all others.
struct HeldSystem {
  std::vector<bool> held;  // per row in contact of all
  Ordering order;
  std::vector<Index> holder;        // per unknown who answers for its row
  std::vector<Index> own_unknowns;  // of own rows, in their order
  Index total = 0;                  // rows of all
  std::unique_ptr<SharedSolver> solver;
  Index own_rows() const {
    return static_cast<Index>(own_unknowns.size());
  }
};

/// A row in contact that does not do what the system was made for [theory: E.38]: one that moves and was held, by a
/// unit jump of it, or one that is held and moved, by a unit force on it.
struct ExchangedRow {
  Eigen::VectorXd own;                              // the response, per unknown that is owned here
  Eigen::VectorXd jumps, forces;                    // of it, per row in contact of all
  std::vector<std::pair<Index, double>> stiffness;  // of a row that was held: forces of a unit jump of it alone
};

/// A triangle at a row in contact, and its condensed matrix.
struct ContactCell {
  Index triangle;
  SkeletonMatrix K;
};

struct SharedBody::Impl {
  Impl(MeshPart given, const Element& e, Scene scene, int threads, const Floating& floating,
       const std::vector<Index>& of_whole, Communicator& with, const std::shared_ptr<const Mesh>& whole);

  // Motions that the supports leave free.

  Eigen::MatrixXd gram();

  /// As one process does (solver/state/model.cpp): what the loads do on them is taken back by a body force.
  void balance(OwnShare own, const Floating& floating);

  // The system [theory: E.34].

  /// From now on these rows in contact are held: by the system that there is and what is exchanged about it, or, where
  /// that is too much, by a system of their own (shared_contact.cpp).
  void hold(const std::vector<bool>& rows);
  void make_system(const std::vector<bool>& rows);
  ExchangedRow exchange(Index row);
  /// Rows of which the system holds another set.
  std::vector<Index> exchanged_rows(const std::vector<bool>& rows) const;
  /// Moves x by what these forces per unknown do; rows that are held stay where they are. Returns the change.
  Eigen::VectorXd settle(const Eigen::VectorXd& forces, DoubleDouble& x);
  /// K x of the triangles at rows in contact alone: all of it where x is nothing but jumps there, and for any x on
  /// these rows.
  Eigen::VectorXd forces_at_contact(const Eigen::VectorXd& x);
  /// Of what is owned here.
  double work(const Eigen::VectorXd& forces, const Eigen::VectorXd& x);
  bool moves(Index unknown) const {
    const Index row = contact_of.empty() ? none : contact_of[static_cast<std::size_t>(unknown)];
    return row == none ? now.order.row[static_cast<std::size_t>(unknown)] != none
                       : !held[static_cast<std::size_t>(row)];
  }
  void drop_factor();
  SharedEffort effort() const;

  /// The values that their holders have, on all who see them. `where`: per triangle the places of what it tells.
  template <typename Where>
  void spread(Eigen::VectorXd& values, const std::vector<Index>& holder, const Where& where);

  // Contact.

  /// Points of all processes, one after the other; rows in contact are numbered in that order.
  void find_contact(const PartOfPaths& paths);

  /// The set that a coarser mesh suggests; none without.
  std::vector<Motion> first_motions(const ContactGuess& guess);

  // Rounds.

  /// Of values per unknown those of the rows in contact, of all.
  Eigen::VectorXd on_contact(const Eigen::VectorXd& values);
  /// Forces per unknown as those on what the sides of cracks see, own rows.
  Eigen::VectorXd on_own_rows(const Eigen::VectorXd& forces) const;
  /// The jump on top of a trace, or none.
  Index jump_at(Index base) const;

  /// Moves x by what own rows do, as all see it.
  void move(const Eigen::VectorXd& own, DoubleDouble& x);
  /// K x, with what the strains theta of the penalty add [theory: E.12]: by the matrices of triangles, kept.
  Eigen::VectorXd forces_of(const DoubleDouble& x, const Eigen::VectorXd& theta);

  /// What one round is judged by.
  struct Round {
    DoubleDouble x;                // per unknown: bodies move by far more than they are strained
    Eigen::VectorXd theta, unmet;  // per triangle, per unknown
    std::vector<Motion> motion;    // per row in contact of all
    double penalty_error = 0;      // PenaltyIterate::penalty_error
    Certificate certificate;
    double size = 0;  // of the energy
  };

  /// Fills in the rest of a round, and the interiors of its fields.
  void judge(Round& r, Field& field);

  /// Moves on to the solution of the equations that a round has left unmet.
  void correct(Round& r, State& state);

  /// One step of the penalty iteration, with its error, after uniform pressures are taken out [theory: E.23].
  /// `must_fit`: UniformPressure::must_fit.
  void step_theta(const Loads& loads, Round& r, int& solves, bool must_fit);

  State solve(const ContactGuess& guess, bool keep_factor);

  // Linear problems on the tangent cone of the contact [theory: A.2] (shared_adjoint.cpp).

  struct Problem {
    std::vector<bool> held;  // per row in contact of all
    Eigen::VectorXd jump;    // of these, 0 on the others
    Eigen::VectorXd load;    // per unknown
    Eigen::VectorXd own;     // per triangle Loads::own, with a penalty
    bool one_sweep = false;  // of the penalty iteration
  };
  /// Fills in residual and counts of the field; its interior is left to others.
  Round solve_linear(const Problem& problem, TangentField& field);
  /// Per row in contact of all.
  std::vector<ContactStatus> status(const Field& state);
  /// By rows in contact of all, as tangent_cone has them.
  std::vector<SlidingPoint> sliding(const Field& state, const std::vector<bool>& held);
  /// Adds to the jumps of normal rows under sliding points minus their shares of the slips, which answer them
  /// [theory: A.15].
  void tie(Problem& problem, const std::vector<SlidingPoint>& sliding, int& solves);
  TangentField solve_adjoint(const Field& state, Sensitivity dJ);
  OneSided one_sided(const Field& state);
  Eigen::VectorXd solve_open(const Eigen::VectorXd& forces);

  Index leading_rows() const {
    return model.inner->ordering.leading();
  }

  Communicator& comm;
  std::vector<std::vector<Index>> shown, also_here;  // MeshPart::shown, seen
  std::vector<Index> process;                        // per triangle
  Model model;
  Precision precision = Precision::Double;  // of the factors of the insides
  std::optional<Elementwise> products = {};
  std::vector<ContactCell> contact_cells = {};
  Eigen::VectorXd applied = {};  // per unknown, what loads are there; after `judge`
  HeldSystem now = {};
  std::vector<bool> held = {};                   // per row in contact of all
  std::map<Index, ExchangedRow> exchanged = {};  // about `now`, by row
  SharedEffort effort_before = {};               // of the systems before
  double stiffest = 0;                           // diagonal entry of the matrices of all processes
  Index unknowns = 0;                            // of the body
  std::vector<ContactPoint> points = {};         // of all
  std::vector<Index> own_contact = {};           // unknowns of own rows in contact, which begin at first_contact
  Index first_contact = 0, contact_rows = 0;
  std::vector<Index> contact_of = {};  // per unknown its row in contact of all
  Eigen::VectorXd gaps = {};           // per row in contact of all its jump at first contact
  std::pair<std::vector<std::vector<double>>, std::vector<double>> own_paths = {};  // PartOfPaths
  UniformPressure uniform = UniformPressure();
};

}  // namespace kerf

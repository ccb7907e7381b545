// The search of k_2 = 0: steps by the expected slope or the secant of the last two answers, kept between the nearest
// answers of either sign once there are both [theory: G.21].

#include "growth/symmetry_search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace kerf::growth {

namespace {

double shear_ratio(const KinkLoad& k) {
  return k.k_1 > 0 ? std::abs(k.k_2) / k.k_1 : infinity;
}

}  // namespace

SymmetrySearch::SymmetrySearch(double first, const SymmetryOptions& options)
    : options_(options), next_(std::clamp(first, -options.largest_turn, options.largest_turn)) {
  if (!std::isfinite(first))
    throw Error(Fault::Usage, fmt::format("the search of a turn begins at {}; a number is wanted", first));
}

std::optional<double> SymmetrySearch::turn() const {
  return next_;
}

void SymmetrySearch::answer(const KinkLoad& k) {
  if (!next_) throw Error(Fault::Usage, "the search of a turn has ended, and an answer came");
  if (!std::isfinite(k.k_1) || !std::isfinite(k.k_2))
    throw Error(Fault::Numerics, fmt::format("k_1 = {}, k_2 = {} behind a turn by {} degrees are no numbers", k.k_1,
                                             k.k_2, *next_ * 180 / pi));
  const Answer now{*next_, k};
  answers_.push_back(now);
  const auto better = [](const KinkLoad& a, const KinkLoad& b) {
    const double first = shear_ratio(a), second = shear_ratio(b);
    return first != second ? first < second : a.k_1 > b.k_1;
  };
  if (answers_.size() == 1 || better(k, answers_[best_].k)) best_ = answers_.size() - 1;
  next_.reset();
  if (found() || static_cast<int>(answers_.size()) >= options_.solves) return;

  // k_2 rises with the turn. Nearest answers on both sides, if they are in order.
  std::optional<Answer>& side = k.k_2 < 0 ? below_ : above_;
  if (!side || (k.k_2 < 0 ? now.turn > side->turn : now.turn < side->turn)) side = now;
  if (below_ && above_ && below_->turn >= above_->turn) (k.k_2 < 0 ? above_ : below_).reset();

  // From a kink that is closed, further to the side to which its shear turns it; else by the slope that is expected, or
  // of the last two answers where that is of its size.
  constexpr double stride = pi / 9;
  double step = k.k_2 > 0 ? -stride : stride;
  if (k.k_1 > 0) {
    double slope = options_.slope * k.k_1;
    if (answers_.size() > 1) {
      const Answer& before = answers_[answers_.size() - 2];
      const double secant = (k.k_2 - before.k.k_2) / (now.turn - before.turn);
      if (before.k.k_1 > 0 && secant > slope / 4 && secant < slope * 4) slope = secant;
    }
    step = std::clamp(-k.k_2 / slope, -2 * stride, 2 * stride);
  }
  double next = std::clamp(now.turn + step, -options_.largest_turn, options_.largest_turn);
  if (below_ && above_ && !(next > below_->turn && next < above_->turn)) next = 0.5 * (below_->turn + above_->turn);
  for (const Answer& a : answers_)
    if (a.turn == next) return;  // nothing new can be asked
  next_ = next;
}

bool SymmetrySearch::found() const {
  return !answers_.empty() && shear_ratio(answers_[best_].k) <= options_.tolerance;
}

const SymmetrySearch::Answer& SymmetrySearch::best() const {
  if (answers_.empty()) throw Error(Fault::Usage, "the best turn of a search is asked before any answer");
  return answers_[best_];
}

double SymmetrySearch::turn_error() const {
  return 2 * shear_ratio(best().k);
}

const std::vector<SymmetrySearch::Answer>& SymmetrySearch::answers() const {
  return answers_;
}

}  // namespace kerf::growth

// Lives by integration of cubics through the logarithms of K.

#include "growth/life.hpp"

#include "growth/numeric/cubic.hpp"
#include "growth/numeric/integral.hpp"
#include "growth/numeric/root.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace kerf::growth {

namespace {

void check_lengths(std::span<const double> a) {
  if (a.size() < 2)
    throw Error(Fault::Usage, fmt::format("a life needs K at two lengths at least; there are {}", a.size()));
  for (std::size_t i = 0; i < a.size(); ++i)
    if (!(a[i] > 0) || !std::isfinite(a[i]) || (i > 0 && !(a[i] > a[i - 1])))
      throw Error(Fault::Usage,
                  fmt::format("length {} of a crack's path is {}; positive lengths that rise are wanted", i + 1, a[i]));
}

// A quantity >= 0 over ln a: its logarithm as a cubic, or itself where it is 0 somewhere.
class Positive {
 public:
  Positive(std::span<const double> x, std::vector<double> y) {
    logarithmic_ = std::all_of(y.begin(), y.end(), [](double v) { return v > 0; });
    for (double& v : y) v = logarithmic_ ? std::log(v) : std::max(v, 0.);
    cubic_ = MonotoneCubic(x, y);
  }
  double operator()(double x) const {
    return logarithmic_ ? std::exp(cubic_(x)) : std::max(cubic_(x), 0.);  // rounding goes below 0
  }

 private:
  bool logarithmic_ = false;
  MonotoneCubic cubic_;
};

std::vector<double> logarithms(std::span<const double> a) {
  std::vector<double> x;
  for (const double v : a) x.push_back(std::log(v));
  return x;
}

using RateAt = std::function<double(double ln_a)>;
using MakeRate = std::function<RateAt(std::span<const std::size_t> points)>;

bool grows(double rate) {
  return rate > 0 && rate < infinity;
}

// Of a path: K_max and dK over ln a.
struct Intensities {
  Positive K_max, dK;
  Intensities(std::span<const double> x, std::span<const PathPoint> path)
      : K_max(x, values(path, [](const PathPoint& p) { return p.K_max; })),
        dK(x, values(path, [](const PathPoint& p) { return p.K_max - p.K_min; })) {}
  template <class Function>
  static std::vector<double> values(std::span<const PathPoint> path, const Function& f) {
    std::vector<double> v;
    for (const PathPoint& p : path) v.push_back(f(p));
    return v;
  }
};

void check_path(std::span<const PathPoint> path) {
  std::vector<double> a;
  for (const PathPoint& p : path) {
    a.push_back(p.a);
    if (!std::isfinite(p.K_max) || !std::isfinite(p.K_min) || p.K_min > p.K_max)
      throw Error(
          Fault::Usage,
          fmt::format("K_max = {}, K_min = {} at length {} of a crack's path; numbers with K_min <= K_max are wanted",
                      p.K_max, p.K_min, p.a));
  }
  check_lengths(a);
}

}  // namespace

struct Life::Inner {
  std::vector<double> a, x, cycles;
  RateAt rate;
  LifeEnd end = LifeEnd::Reached;
  double end_x = 0, total = 0, error = nan;

  Inner(std::vector<double> lengths, RateAt f) : a(std::move(lengths)), x(logarithms(a)), rate(std::move(f)) {
    cycles.assign(a.size(), 0);
    for (std::size_t i = 0; i + 1 < a.size(); ++i) {
      const double stop = stops(x[i], x[i + 1]);
      end_x = stop;
      total = cycles[i] + spent(x[i], stop);
      const double there = rate(stop), beyond = grows(there) ? rate(std::nextafter(stop, infinity)) : there;
      if (stop < x[i + 1]) {
        end = beyond == infinity ? LifeEnd::Runs : LifeEnd::Rests;
        for (std::size_t j = i + 1; j < a.size(); ++j) cycles[j] = end == LifeEnd::Runs ? total : infinity;
        if (end == LifeEnd::Rests) total = infinity;
        return;
      }
      cycles[i + 1] = total;
    }
  }

  double spent(double low, double high) const {
    return integral(
        [&](double s) {
          const double r = rate(s);
          return r == infinity ? 0 : std::exp(s) / r;
        },
        low, high);
  }

  // Up to where the crack grows in [low, high].
  double stops(double low, double high) const {
    if (!grows(rate(low))) return low;
    constexpr int samples = 32;
    for (int i = 1; i <= samples; ++i) {
      double beyond = i == samples ? high : low + (high - low) * i / samples;
      if (grows(rate(beyond))) continue;
      double before = low + (high - low) * (i - 1) / samples;
      while (true) {
        const double middle = 0.5 * (before + beyond);
        if (middle <= before || middle >= beyond) return before;
        (grows(rate(middle)) ? before : beyond) = middle;
      }
    }
    return high;
  }

  double cycles_at(double s) const {
    if (s > end_x) return end == LifeEnd::Rests ? infinity : total;
    const auto i = std::clamp<std::ptrdiff_t>(std::upper_bound(x.begin(), x.end(), s) - x.begin() - 1, 0,
                                              static_cast<std::ptrdiff_t>(x.size()) - 2);
    return cycles[i] + spent(x[i], s);
  }

  static std::shared_ptr<const Inner> make(std::span<const double> a, const MakeRate& rates) {
    std::vector<std::size_t> all;
    for (std::size_t i = 0; i < a.size(); ++i) all.push_back(i);
    auto made = std::make_shared<Inner>(std::vector<double>(a.begin(), a.end()), rates(all));
    if (a.size() == 2) return made;
    const std::vector<std::size_t> kept = every_second(a.size());
    std::vector<double> lengths;
    for (const std::size_t i : kept) lengths.push_back(a[i]);
    const Inner coarse(std::move(lengths), rates(kept));
    made->error = made->total == coarse.total ? 0 : std::abs(made->total - coarse.total);
    return made;
  }
};

Life::Life(std::shared_ptr<const Inner> inner) : inner_(std::move(inner)) {}

Life::Life(const GrowthLaw& law, std::span<const PathPoint> path) {
  check(law);
  check_path(path);
  const std::vector<double> a = Intensities::values(path, [](const PathPoint& p) { return p.a; });
  inner_ = Inner::make(a, [&](std::span<const std::size_t> points) -> RateAt {
    std::vector<double> x;
    std::vector<PathPoint> used;
    for (const std::size_t i : points) {
      used.push_back(path[i]);
      x.push_back(std::log(path[i].a));
    }
    return [law, k = Intensities(x, used)](double s) {
      const double K_max = k.K_max(s);
      return rate(law, K_max, K_max - k.dK(s), std::exp(s));
    };
  });
}

Life Life::of_rates(std::span<const double> a, std::span<const double> rates) {
  check_lengths(a);
  if (rates.size() != a.size())
    throw Error(Fault::Usage,
                fmt::format("{} rates for {} lengths of a crack; as many are wanted", rates.size(), a.size()));
  for (const double r : rates)
    if (!(r >= 0)) throw Error(Fault::Usage, fmt::format("a rate of growth is {}; 0 or more is wanted", r));
  return Life(Inner::make(a, [&](std::span<const std::size_t> points) -> RateAt {
    std::vector<double> x, finite;
    double runs = infinity;  // from here on
    for (const std::size_t i : points) {
      if (rates[i] == infinity) {
        runs = std::log(a[i]);
        break;
      }
      x.push_back(std::log(a[i]));
      finite.push_back(rates[i]);
    }
    if (x.empty()) return [](double) { return infinity; };
    return [f = Positive(x, finite), runs](double s) { return s >= runs ? infinity : f(s); };
  }));
}

double Life::cycles() const {
  return inner_->total;
}
double Life::error() const {
  return inner_->error;
}
LifeEnd Life::end() const {
  return inner_->end;
}
double Life::end_length() const {
  const auto point = std::find(inner_->x.begin(), inner_->x.end(), inner_->end_x);
  return point == inner_->x.end() ? std::exp(inner_->end_x) : inner_->a[point - inner_->x.begin()];
}
const std::vector<double>& Life::cycles_at_points() const {
  return inner_->cycles;
}

double Life::cycles_at(double a) const {
  const Inner& in = *inner_;
  if (!(a >= in.a.front() && a <= in.a.back()))
    throw Error(Fault::Usage, fmt::format("cycles at length {} are asked; the path has lengths from {} to {}", a,
                                          in.a.front(), in.a.back()));
  return in.cycles_at(std::log(a));
}

double Life::length_at(double cycles) const {
  const Inner& in = *inner_;
  if (!(cycles >= 0))
    throw Error(Fault::Usage, fmt::format("the length after {} cycles is asked; 0 or more is wanted", cycles));
  if (cycles == 0) return in.a.front();
  if (cycles >= in.total) return end_length();
  std::size_t i = 0;
  while (i + 2 < in.x.size() && in.cycles[i + 1] <= cycles) ++i;
  const double high = std::min(in.x[i + 1], in.end_x);
  return std::exp(root([&](double s) { return in.cycles[i] + in.spent(in.x[i], s) - cycles; }, in.x[i], high));
}

std::optional<double> length_at_K(std::span<const PathPoint> path, double K) {
  check_path(path);
  const std::vector<double> x = logarithms(Intensities::values(path, [](const PathPoint& p) { return p.a; }));
  const Intensities k(x, path);
  if (path[0].K_max >= K) return path[0].a;
  for (std::size_t i = 1; i < path.size(); ++i)
    if (path[i].K_max >= K) return std::exp(root([&](double s) { return k.K_max(s) - K; }, x[i - 1], x[i]));
  return {};
}

namespace {

void check_bounds(std::span<const BoundedCycle> path) {
  std::vector<double> a;
  for (const BoundedCycle& p : path) {
    a.push_back(p.a);
    if (!(p.K_max_lower <= p.K_max_upper) || !(p.K_min_lower <= p.K_min_upper) || !(p.K_min_lower <= p.K_max_upper))
      throw Error(Fault::Usage, fmt::format("K_max in [{}, {}], K_min in [{}, {}] at length {} of a crack's path: "
                                            "bounds that hold a cycle are wanted",
                                            p.K_max_lower, p.K_max_upper, p.K_min_lower, p.K_min_upper, p.a));
  }
  check_lengths(a);
}

// The least and the largest rate over all cycles within bounds. Every law rises with K_max and falls with K_min.
LifeBounds rates_within(const GrowthLaw& law, const BoundedCycle& p, double other_a) {
  const bool sampled = std::holds_alternative<Nasgro>(law.form);
  LifeBounds r{infinity, 0};
  const auto take = [&](double K_max, double K_min) {
    for (const double a : {p.a, other_a}) {
      const double v = K_min >= K_max ? 0 : rate(law, K_max, K_min, a);
      r = {std::min(r.lower, v), std::max(r.upper, v)};
    }
  };
  take(p.K_max_upper, p.K_min_lower);
  take(p.K_max_lower, p.K_min_upper);
  const auto between = [](double low, double high, int i) { return i == 4 ? high : low + (high - low) * i / 4; };
  for (int i = 0; sampled && i < 25; ++i)
    take(between(p.K_max_lower, p.K_max_upper, i / 5), between(p.K_min_lower, p.K_min_upper, i % 5));
  return r;
}

}  // namespace

LifeBounds bound_life(const GrowthLaw& law, std::span<const BoundedCycle> path, BetweenPoints between) {
  check(law);
  check_bounds(path);
  if (between == BetweenPoints::Smooth) {
    if (path.size() < 3)
      throw Error(Fault::Usage,
                  fmt::format("bounds of a life between points need three of them; there are {}", path.size()));
    std::vector<PathPoint> fast, slow;
    for (const BoundedCycle& p : path) {
      fast.push_back({p.a, p.K_max_upper, p.K_min_lower});
      slow.push_back({p.a, std::max(p.K_max_lower, p.K_min_upper), p.K_min_upper});
    }
    const Life first(law, fast), last(law, slow);
    const double lower = first.cycles() == infinity ? infinity : std::max(0., first.cycles() - first.error());
    return {lower, last.cycles() == infinity ? infinity : last.cycles() + last.error()};
  }
  LifeBounds life;
  bool may_run = false;
  for (std::size_t i = 0; i + 1 < path.size() && path[i].K_max_lower < law.K_c; ++i) {
    const BoundedCycle &p = path[i], &q = path[i + 1];
    const BoundedCycle both{p.a, std::min(p.K_max_lower, q.K_max_lower), std::max(p.K_max_upper, q.K_max_upper),
                            std::min(p.K_min_lower, q.K_min_lower), std::max(p.K_min_upper, q.K_min_upper)};
    const LifeBounds rates = rates_within(law, both, q.a);
    may_run = may_run || rates.upper == infinity;
    if (!may_run) life.lower += (q.a - p.a) / rates.upper;
    life.upper += (q.a - p.a) / rates.lower;
  }
  return life;
}

}  // namespace kerf::growth

// The symbolic phase of the sparse Cholesky factorization, by CHOLMOD and METIS, which live here and nowhere else.
// Order: nested dissection by METIS [theory: E.28]; above 20,000 vertices its first separator cuts the graph in two,
// above 100,000 those of both halves in four, and the parts are ordered side by side, as the size of the graph alone
// decides: the same order for any number of threads. Analysis: rows that are coupled to the same rows and follow each
// other are one node; CHOLMOD finds the elimination tree and relaxed supernodes of that graph, which is sixteen times
// smaller where nodes have four rows, and these are taken back to rows. Only patterns are looked at.
// docs/theory/elements.md, section The factor.

#include "solver/system/symbolic.hpp"

#include "base/parallel.hpp"
#include "kerf/stop.hpp"
#include "solver/factor.hpp"
#include "solver/system/blas.hpp"
#include "solver/system/generator.hpp"

#include <cholmod.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <memory>
#include <mutex>
#include <numeric>
#include <utility>

namespace kerf {

namespace {

// Views of arrays that Eigen or a vector owns; CHOLMOD only reads them.
cholmod_sparse view(Index n, Index* start, Index* rows, int stype) {
  cholmod_sparse a{};
  a.nrow = a.ncol = static_cast<std::size_t>(n);
  a.nzmax = static_cast<std::size_t>(start[n]);
  a.p = start;
  a.i = rows;
  a.stype = stype;
  a.itype = CHOLMOD_INT;
  a.xtype = CHOLMOD_PATTERN;
  a.dtype = CHOLMOD_DOUBLE;
  a.sorted = 1;
  a.packed = 1;
  return a;
}

struct Session {  // a CHOLMOD workspace with its lifetime
  cholmod_common c{};
  Session() {
    cholmod_start(&c);
    c.print = 0;
    c.error_handler = nullptr;
  }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;
  ~Session() {
    cholmod_finish(&c);
  }
};

/// Undirected: for each vertex its neighbors, both directions, without itself.
struct EliminationGraph {
  std::vector<Index> start{0}, neighbors;
  Index size() const {
    return static_cast<Index>(start.size()) - 1;
  }
};

/// work(matrix, session) for the upper triangle of a graph. CHOLMOD reads it alone with stype 1; without a stype the
/// pattern would stand for A A'.
template <typename Work>
void on_upper(const EliminationGraph& g, const Work& work) {
  check_stop();
  Session session;
  std::vector<Index> start(g.start.size(), 0), upper;
  upper.reserve(g.neighbors.size() / 2);
  for (Index j = 0; j < g.size(); ++j) {
    for (Index p = g.start[j]; p < g.start[j + 1]; ++p)
      if (g.neighbors[p] < j) upper.push_back(g.neighbors[p]);
    start[j + 1] = static_cast<Index>(upper.size());
  }
  if (upper.empty()) upper.push_back(0);
  cholmod_sparse a = view(g.size(), start.data(), upper.data(), 1);
  a.sorted = 0;
  work(a, session.c);
}

/// The order of all vertices, postordered.
std::vector<Index> order_of(const EliminationGraph& g) {
  std::vector<Index> order(static_cast<std::size_t>(g.size()));
  if (g.size() == 0) return order;
  on_upper(g, [&](cholmod_sparse& a, cholmod_common& c) {
    if (!cholmod_metis(&a, nullptr, 0, 1, order.data(), &c)) out_of_memory();
  });
  return order;
}

/// Whether METIS draws from a generator per thread, tried on two vertices.
bool has_generator_per_thread() {
  static const bool has = [] {
    const unsigned before = seeds_of_metis();
    order_of({.start = {0, 1, 2}, .neighbors = {1, 0}});
    return seeds_of_metis() != before;
  }();
  return has;
}

/// Per vertex 0 or 1, no neighbors, or 2, a separator between them.
/// CHOLMOD's bisection by METIS of the graph as it is (no compression): the separator is of vertices.
std::vector<Index> sides_of(const EliminationGraph& g) {
  std::vector<Index> side(static_cast<std::size_t>(g.size()));
  on_upper(g, [&](cholmod_sparse& a, cholmod_common& c) {
    if (cholmod_bisect(&a, nullptr, 0, 0, side.data(), &c) < 0) out_of_memory();
  });
  return side;
}

/// Some vertices of the whole graph, one after the other in the order of elimination or still to be ordered.
struct Part {
  std::vector<Index> vertices;
  EliminationGraph graph;  // of those still to be ordered, in their numbers here
};

// The separator needs no graph: its vertices are eliminated last, in the order in which they come.
Part part_of(const Part& from, const std::vector<Index>& side, Index which) {
  Part part;
  std::vector<Index> number(side.size(), none);
  for (std::size_t v = 0; v < side.size(); ++v)
    if (side[v] == which) {
      number[v] = static_cast<Index>(part.vertices.size());
      part.vertices.push_back(from.vertices[v]);
    }
  constexpr Index separator = 2;
  if (which == separator) return part;
  for (std::size_t v = 0; v < side.size(); ++v) {
    if (side[v] != which) continue;
    for (Index p = from.graph.start[v]; p < from.graph.start[v + 1]; ++p)
      if (const Index w = number[static_cast<std::size_t>(from.graph.neighbors[static_cast<std::size_t>(p)])];
          w != none)
        part.graph.neighbors.push_back(w);
    part.graph.start.push_back(static_cast<Index>(part.graph.neighbors.size()));
  }
  return part;
}

}  // namespace

// The first separators cut large graphs into parts that are ordered side by side. How often they do depends on the size
// of the graph alone.
std::vector<Index> dissection(const std::vector<Index>& start, const std::vector<Index>& neighbors, int threads) {
  // From a generator of all threads METIS would draw other numbers in each run.
  static std::mutex one_at_a_time;
  std::unique_lock lock(one_at_a_time, std::defer_lock);
  if (!has_generator_per_thread()) {
    lock.lock();
    threads = 1;
  }
  std::vector<Part> parts(1);
  parts[0].graph = {start, neighbors};
  parts[0].vertices.resize(start.size() - 1);
  std::iota(parts[0].vertices.begin(), parts[0].vertices.end(), 0);
  constexpr std::array<std::size_t, 2> worth_it{20000, 100000};  // vertices
  const auto levels = std::ranges::count_if(worth_it, [&](std::size_t size) { return start.size() > size; });
  const auto each = [&](const auto& body) {
    parallel_tasks(static_cast<Index>(parts.size()), threads, [&](Index i) {
      if (parts[static_cast<std::size_t>(i)].graph.size() > 0) body(static_cast<std::size_t>(i));
    });
  };
  for (std::ptrdiff_t level = 0; level < levels; ++level) {
    std::vector<std::array<Part, 3>> cut(parts.size());
    each([&](std::size_t i) {
      const std::vector<Index> side = sides_of(parts[i].graph);
      for (Index which = 0; which < 3; ++which)
        cut[i][static_cast<std::size_t>(which)] = part_of(parts[i], side, which);
    });
    std::vector<Part> next;
    for (std::size_t i = 0; i < parts.size(); ++i)
      if (parts[i].graph.size() > 0)
        std::ranges::move(cut[i], std::back_inserter(next));
      else
        next.push_back(std::move(parts[i]));
    parts = std::move(next);
  }
  each([&](std::size_t i) {
    std::vector<Index> order = order_of(parts[i].graph);
    for (Index& v : order) v = parts[i].vertices[static_cast<std::size_t>(v)];
    parts[i].vertices = std::move(order);
  });
  std::vector<Index> order;
  order.reserve(start.size() - 1);
  for (const Part& part : parts) order.insert(order.end(), part.vertices.begin(), part.vertices.end());
  return order;
}

namespace {

/// Rows in a row that the same rows see and that see the same: a graph without values, sixteen times smaller than the
/// matrix where each node has four rows.
struct Nodes {
  std::vector<Index> first;        // of the rows of each node, one more at the end
  std::vector<Index> start, rows;  // the lower triangle of what is coupled, as LowerTriangle has it
  Index count() const {
    return static_cast<Index>(first.size()) - 1;
  }
  Index width(Index k) const {
    return first[static_cast<std::size_t>(k) + 1] - first[static_cast<std::size_t>(k)];
  }
};

// A node begins where the column differs from the one before by more than its own row, or where a column of another row
// has only one of two neighbors.
Nodes nodes_of(const LowerTriangle& a) {
  const auto size = static_cast<std::size_t>(a.size);
  std::vector<bool> begins(size + 1, false);  // a node
  begins[0] = begins[size] = true;
  for (std::size_t j = 0; j < size; ++j) {
    const Index *from = a.rows.data() + a.start[j], *end = a.rows.data() + a.start[j + 1];
    for (const Index* r = from + 1; r < end; ++r)  // a column that has one of two neighbors alone parts them
      if (r[0] != r[-1] + 1)
        begins[static_cast<std::size_t>(r[-1]) + 1] = begins[static_cast<std::size_t>(r[0])] = true;
    begins[static_cast<std::size_t>(end[-1]) + 1] = true;
    if (j + 1 < size && !std::equal(from + 1, end, end, a.rows.data() + a.start[j + 2])) begins[j + 1] = true;
  }
  Nodes nodes;
  std::vector<Index> of(size);
  for (std::size_t j = 0; j < size; ++j) {
    if (begins[j]) nodes.first.push_back(static_cast<Index>(j));
    of[j] = static_cast<Index>(nodes.first.size()) - 1;
  }
  nodes.first.push_back(a.size);
  nodes.start.push_back(0);
  for (Index k = 0; k < nodes.count(); ++k) {
    const auto j = static_cast<std::size_t>(nodes.first[static_cast<std::size_t>(k)]);
    for (Index p = a.start[j]; p < a.start[j + 1]; p += nodes.width(nodes.rows.back()))
      nodes.rows.push_back(of[static_cast<std::size_t>(a.rows[static_cast<std::size_t>(p)])]);
    nodes.start.push_back(static_cast<Index>(nodes.rows.size()));
  }
  return nodes;
}

// Its order is one of the nodes. `postorder`: else the order must stay as it is.
// Supernodal analysis with the order as it comes, postordered or not. Relaxation merges supernodes at the price of some
// zeros.
Symbolic analyze_nodes(const Nodes& nodes, bool postorder) {
  Session session;
  cholmod_common& c = session.c;
  c.supernodal = CHOLMOD_SUPERNODAL;
  c.nmethods = 1;
  c.method[0].ordering = CHOLMOD_NATURAL;
  // Fewer zeros in merged supernodes than by default: 4 to 7 % less memory; speed within the noise of the
  // measurement. Small matrices spend their time on the calls per supernode, not inside: 6600 unknowns of a lattice
  // take 9.2 ms with the narrow ones, 6.1 by default, 4.7 with wide ones. In rows; CHOLMOD counts nodes.
  constexpr std::array<double, 3> narrow{1, 4, 12}, wide{8, 32, 96};
  const Index rows = nodes.first.back();
  const double per_node = double(rows) / nodes.count();
  for (std::size_t k = 0; k < 3; ++k)
    c.nrelax[k] = static_cast<std::size_t>(std::max(1.0, std::round((rows < 30000 ? wide : narrow)[k] / per_node)));
  c.postorder = postorder ? 1 : 0;
  cholmod_sparse a =
      view(nodes.count(), const_cast<Index*>(nodes.start.data()), const_cast<Index*>(nodes.rows.data()), -1);
  cholmod_factor* factor = cholmod_analyze(&a, &c);
  if (!factor) out_of_memory();
  const auto free = [&c](cholmod_factor* f) { cholmod_free_factor(&f, &c); };
  const std::unique_ptr<cholmod_factor, decltype(free)> freed(factor, free);
  const auto list = [](const void* at, std::size_t count) {
    const auto* from = static_cast<const Index*>(at);
    return std::vector<Index>(from, from + count);
  };
  const std::vector<Index> first = list(factor->super, factor->nsuper + 1),
                           rows_start = list(factor->pi, factor->nsuper + 1), seen = list(factor->s, factor->ssize),
                           counts = list(factor->ColCount, factor->n);
  Symbolic found{.order = list(factor->Perm, factor->n)};
  std::vector<Index> row{0};  // where the rows of each node are in the new order
  for (const Index k : found.order) row.push_back(row.back() + nodes.width(k));
  Supernodes& s = found.supernodes;
  std::size_t all = 0;
  for (const Index k : seen)
    all += static_cast<std::size_t>(row[static_cast<std::size_t>(k) + 1] - row[static_cast<std::size_t>(k)]);
  s.rows.reserve(all);
  for (std::size_t n = 0; n + 1 < first.size(); ++n) {
    for (Index p = rows_start[n]; p < rows_start[n + 1]; ++p) {
      const auto k = static_cast<std::size_t>(seen[static_cast<std::size_t>(p)]);
      for (Index r = row[k]; r < row[k + 1]; ++r) s.rows.push_back(r);
    }
    s.first.push_back(row[static_cast<std::size_t>(first[n + 1])]);
    s.rows_start.push_back(static_cast<Index>(s.rows.size()));
    const double per_node = double(s.rows_start[n + 1] - s.rows_start[n]) / (rows_start[n + 1] - rows_start[n]);
    for (auto k = static_cast<std::size_t>(first[n]); k < static_cast<std::size_t>(first[n + 1]); ++k) {
      const double behind = (counts[k] - 1) * per_node;
      for (Index left = row[k + 1] - row[k]; left > 0; --left) {
        found.entries += left + behind;
        found.flops += (left + behind) * (left + behind);
      }
    }
  }
  return found;
}

}  // namespace

// With a sequence subtrees are put together, for the stack of the fronts. Without one the order of the rows stays,
// since those in contact and on an interface must come last.
Symbolic analyze_pattern(const LowerTriangle& lower, std::span<const Index> sequence) {
  const bool permuted = !sequence.empty();
  LowerTriangle pattern;
  if (permuted) {
    pattern = reordered({lower.size, lower.start, lower.rows, {}}, sequence);
    for (Index j = 0; j < lower.size; ++j)
      std::sort(pattern.rows.begin() + pattern.start[j], pattern.rows.begin() + pattern.start[j + 1]);
  }
  // `dissection` is a postorder already, and last rows must stay where they are.
  const Nodes nodes = nodes_of(permuted ? std::as_const(pattern) : lower);
  Symbolic found = analyze_nodes(nodes, permuted);
  std::vector<Index> order;
  order.reserve(static_cast<std::size_t>(lower.size));
  for (const Index k : found.order)
    for (Index r = nodes.first[static_cast<std::size_t>(k)]; r < nodes.first[static_cast<std::size_t>(k) + 1]; ++r)
      order.push_back(permuted ? sequence[static_cast<std::size_t>(r)] : r);
  found.order = std::move(order);
  return found;
}

}  // namespace kerf

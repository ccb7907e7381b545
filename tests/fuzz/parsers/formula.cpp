// Formulas, the last line, with definitions before it ("name = formula" each): a function, whose values lie within what
// is proved of it; or an Error.

#include "io/case/syntax.hpp"
#include "tests/fuzz/parsers/promise.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace kerf;
  ExpressionContext context{.young = 2, .poisson = 0.3};
  std::string_view rest = parsers::text(data, size);
  for (std::size_t end; (end = rest.find('\n')) != rest.npos; rest.remove_prefix(end + 1)) {
    const std::string_view line = rest.substr(0, end);
    const std::size_t equals = std::min(line.find('='), line.size());
    context.definitions.push_back(
        {std::string(line.substr(0, equals)), std::string(line.substr(std::min(equals + 1, line.size())))});
  }
  parsers::promise([&] { wrong_definition(context); });
  parsers::promise([&] {
    const Expression f = parse_expression(rest, context);
    const auto syntax = syntax_of(rest, context);
    if (!syntax) return;
    degree_of(*syntax);
    const Interval x{0.25, 0.5}, y{-1, 2}, within = enclose(*syntax, x, y);
    deviation(*syntax, x, y, 2);
    const EdgeLine edge{{0, 0}, {1, 0}, {0, -1}};
    enclose(syntax, edge, 0, 1);
    for (const Vec2& at : {Vec2(0.25, -1), Vec2(0.3, 0), Vec2(0.5, 2)})
      parsers::promise([&] {
        const double value = f(at, Vec2(1, 0));
        parsers::require(value >= within.low && value <= within.high, "the value lies within what is proved");
      });
  });
  return 0;
}

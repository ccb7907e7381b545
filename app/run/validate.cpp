// The validation of a run: solved, written, drawn.

#include "app/run/validate.hpp"

#include "io/drawn_change.hpp"
#include "io/validation.hpp"
#include "kerf/stop.hpp"
#include "plot/charts.hpp"

namespace kerf {

ValidationResult validate_expansion(const Case& c, const Body& body, Journal& journal) {
  journal.begin("validate");
  ValidationRequest request = *c.validate;
  request.threads = journal.options.threads;
  request.scenes = scenes_of_changes(c);
  const ValidationResult result{std::string(word(request.perturbation.kind)),
                                validate({body.shape, body.sizing}, body.element, body.scene, c.functional, request)};
  journal.seconds.validate = journal.lap();
  if (!stop_requested()) journal.begin("write the validation");
  journal.later([path = journal.file("validate.csv"), result] { write_validation_csv(path, result); });
  journal.picture("validate.png", [&] { return validation_chart(result, journal.title); });
  journal.seconds.output += journal.lap();
  check_stop();
  return result;
}

}  // namespace kerf

"""The designs that numbers draw, for optimizers that are not kerf's."""

import numpy


class DesignValues:
    def __init__(self, values):
        self.__dict__.update(values)
        self.failure = values["failure"] or None

    def __repr__(self):
        if self.failure:
            return f"<kerf.DesignValues: {self.failure}>"
        worst = f", largest constraint {self.constraints.max():.4g}" if len(self.constraints) else ""
        return f"<kerf.DesignValues: value {self.value:.6g}, volume {100 * self.volume_fraction:.4g} %{worst}>"


class Designs:
    # Docstrings of what users see stand in __init__.pyi (_documented.py).

    def __init__(self, designs):
        self._designs = designs
        self.names, self.constraints = designs.names, designs.constraints
        self.lower, self.upper, self.start = designs.lower, designs.upper, designs.start
        self._last = self._good = None  # (x, values) of the last evaluation, and of the last that succeeded

    def __repr__(self):
        return f"<kerf.Designs: {', '.join(self.names)}; {len(self.constraints)} constraints>"

    def __len__(self):
        return len(self.names)

    def evaluate(self, x, *, gradient=True):
        x = numpy.array(x, dtype=float).ravel()
        if self._last is not None:
            at, values = self._last
            if numpy.array_equal(at, x) and (values.gradient is not None or not gradient):
                return values
        values = DesignValues(self._designs.evaluate(x, gradient))
        self._last = x, values
        if not values.failure and gradient:
            self._good = x, values
        return values

    def new_mesh(self):
        self._designs.forget_meshes()
        self._last = None

    def scipy(self):
        def inside(x):  # SciPy leaves the box by rounding
            return numpy.clip(x, self.lower, self.upper)

        def function(x):
            values = self.evaluate(inside(x))
            if not values.failure:
                return values.value, values.gradient
            if self._good is None:
                from ._errors import SolveError

                raise SolveError(f"the first design cannot be evaluated: {values.failure}")
            at, good = self._good  # worse than the last one that could be, so that a line search comes back
            return good.value + abs(good.value) + abs(float(good.gradient @ (x - at))), good.gradient

        def jacobian(x):
            values = self.evaluate(inside(x))
            return -(self._good[1] if values.failure else values).jacobian

        def room(x):
            values = self.evaluate(inside(x)).constraints
            return -numpy.where(numpy.isfinite(values), values, 1.0)

        limits = [{"type": "ineq", "fun": room, "jac": jacobian}] if self.constraints else []
        return {"fun": function, "jac": True, "x0": self.start.copy(), "bounds": list(zip(self.lower, self.upper)),
                "constraints": limits}

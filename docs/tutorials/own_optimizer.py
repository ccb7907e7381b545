"""An optimizer of your own: where to put a hole of given size, by kerf's values and exact gradients.

Run it with python3. The second half uses SciPy, if that is installed.
"""

import numpy

import kerf

# 1. What may vary: the center and the radius of a hole, each within two bounds. J is the compliance; the body may keep at
#    most 93 % of its area.
cantilever = kerf.Case({
    "domain": {"outline": [[0, 0], [2, 0], [2, 1], [0, 1]], "sides": ["bottom", "right", "top", "left"]},
    "material": {"young": 1.0, "poisson": 0.3},
    "boundary": [{"on": "left", "displacement": [0, 0]}, {"on": "right", "traction": [0, -1]}],
    "mesh": {"size": 0.2},
    "functional": {"kind": "compliance"},
    "optimize": {"method": "slsqp", "volume": {"at_most": 0.93}, "hole": [
        {"name": "h", "circle": {"center": [[0.4, 1.6], [0.35, 0.65]], "radius": [0.1, 0.25]},
         "start": {"center": [0.8, 0.45], "radius": 0.22}}]},
})
designs = cantilever.designs()
print(designs.names, designs.lower, designs.upper)

# 2. One evaluation: the value, its gradient, and constraints, which are to be at most 0. The gradient is that of the
#    values themselves: central differences agree.
values = designs.evaluate(designs.start)
print(values, values.gradient, dict(zip(designs.constraints, values.constraints)))
step = 1e-4
for k in range(len(designs)):
    there = [designs.evaluate(designs.start + s * step * numpy.eye(3)[k], gradient=False).value for s in (1, -1)]
    difference = (there[0] - there[1]) / (2 * step)
    assert abs(difference - values.gradient[k]) < 1e-4 * abs(values.gradient).max(), (difference, values.gradient[k])

# 3. An optimizer in ten lines: steps along the gradient inside the box, half as long where they do not pay. The radius
#    stays where the volume wants it.
x, length = designs.start.copy(), 0.2
best = designs.evaluate(x)
for _ in range(12):
    direction = -best.gradient * [1, 1, 0]
    trial = numpy.clip(x + length * direction / numpy.linalg.norm(direction), designs.lower, designs.upper)
    found = designs.evaluate(trial)
    if not found.failure and found.value < best.value:
        x, best = trial, found
        designs.new_mesh()
    else:
        length /= 2
print("by hand:", x, best.value)
assert best.value < values.value

# 4. The same with SciPy, radius and volume included, and with the method of the case for comparison.
ours = cantilever.optimize()
print("kerf:   ", ours["optimize"]["objective"], ours["optimize"]["stopped"])
print("the design as a case:", ours.design)
try:
    import scipy.optimize
except ImportError:
    print("SciPy is not installed")
else:
    designs.new_mesh()
    found = scipy.optimize.minimize(**designs.scipy(), method="SLSQP", options={"maxiter": 40, "ftol": 1e-5})
    print("SciPy:  ", found.x, found.fun, found.message)
    assert designs.evaluate(numpy.clip(found.x, designs.lower, designs.upper)).constraints.max() < 1e-4
    assert abs(found.fun / ours["optimize"]["objective"] - 1) < 0.02

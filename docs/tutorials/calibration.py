"""Calibration: Young's modulus and Poisson's ratio from measured displacements, by least squares of your own.

Run it with python3. Nothing is measured here: the readings are those of a finer computation, with noise.
"""

import numpy

import kerf

specimen = {
    "domain": {"outline": [[0, 0], [2, 0], [2, 1], [0, 1]], "sides": ["bottom", "right", "top", "left"]},
    "hole": [{"name": "h", "circle": {"center": [1, 0.5], "radius": 0.2}}],
    "material": {"young": 70e3, "poisson": 0.33, "state": "plane stress"},
    "boundary": [{"on": "left", "displacement": [0, 0]}, {"on": "right", "traction": [50, 0]}],
    "mesh": {"size": 0.25},
}

# 1. The camera: 60 points, displacements in x and y, each with an error of 2 micrometers of 1500. Points in the hole have
#    no reading: `at` says so by NaN.
random = numpy.random.default_rng(1)
points = numpy.column_stack([random.uniform(0.1, 1.9, 60), random.uniform(0.1, 0.9, 60)])
seen = kerf.Case(specimen, set={"mesh.size": 0.15}).solve().at(points)
points = points[seen.inside]
noise = 2e-6
readings = seen.displacement[seen.inside] + noise * random.standard_normal((len(points), 2))
print(f"{len(points)} of 60 points are on the specimen")


# 2. The model: readings that a pair (young, poisson) would give.
def model(parameters):
    young, poisson = parameters
    result = kerf.Case(specimen, set={"material.young": young, "material.poisson": poisson}).solve()
    return result.at(points).displacement


def misfit(parameters):
    return ((model(parameters) - readings) / noise).ravel()


# 3. Gauss-Newton with differences. The matrix J'J at the end is the inverse of the covariance of what was found.
x = numpy.array([50e3, 0.2])
for _ in range(6):
    r = misfit(x)
    J = numpy.column_stack([(misfit(x + h) - r) / h.sum() for h in numpy.diag([1e-3 * x[0], 1e-3])])
    step = numpy.linalg.lstsq(J, -r, rcond=None)[0]
    x = x + step
    print(f"young {x[0]:9.1f}, poisson {x[1]:.4f}, misfit {numpy.sqrt((r**2).mean()):8.3f} standard deviations")
    if abs(step[0]) < 1e-4 * x[0]:
        break
deviation = numpy.sqrt(numpy.diag(numpy.linalg.inv(J.T @ J)))
print(f"young {x[0]:.0f} +- {deviation[0]:.0f}, poisson {x[1]:.4f} +- {deviation[1]:.4f}")
assert abs(x[0] - 70e3) < 5 * deviation[0] and abs(x[1] - 0.33) < 5 * deviation[1]
assert 0.8 < numpy.sqrt((misfit(x) ** 2).mean()) < 1.2  # what is left is the noise: the model explains the readings

# 4. The same by SciPy, if that is installed.
try:
    import scipy.optimize
except ImportError:
    print("SciPy is not installed")
else:
    found = scipy.optimize.least_squares(misfit, [50e3, 0.2], x_scale=[1e4, 0.1], diff_step=1e-3)
    print("SciPy:", found.x)
    assert abs(found.x[0] / x[0] - 1) < 1e-3

#!/usr/bin/python3
# SIMP for the scenarios of `kerf bench optimize`: simp_scenario.py SCENARIO.json CELLS ITERATIONS FILE [--strong]
# Plain: bilinear squares, penalty 3, sensitivity filter of max(2.5 cells, 0.03), optimality criteria, until no density
# changes by 0.01 [Sigmund 2001]. Strong: density filter of 4.5 cells with a Heaviside projection whose sharpness grows
# [Wang, Lazarov, Sigmund 2011], from a run on half as many cells whose penalty grows from 1 to 3.
# FILE: per iteration a line "iteration objective seconds states columns rows", then minus the density at the points row
# by row from the bottom; writing costs no time.
import json, sys, time
import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as sl
from scipy.ndimage import convolve, zoom

VOID = 1e-9          # stiffness of no material
MOVE = 0.2           # of a density in one iteration


def inside(points, polygon):
    """Whether points lie in a polygon, by crossings of a ray."""
    result = np.zeros(len(points), bool)
    for a, b in zip(polygon, polygon[1:] + polygon[:1]):
        if a[1] == b[1]: continue
        straddles = (a[1] > points[:, 1]) != (b[1] > points[:, 1])
        at = a[0] + (points[:, 1] - a[1]) * (b[0] - a[0]) / (b[1] - a[1])
        result ^= straddles & (points[:, 0] < at)
    return result


def along(points, a, b):
    """Points on a segment, in its order; where there is none, the nearest to its middle."""
    a, d = np.array(a, float), np.subtract(b, a).astype(float)
    t = (points - a) @ d / (d @ d)
    away = np.hypot(*(points - a - np.outer(t, d)).T)
    on = np.flatnonzero((away < 1e-6) & (t > -1e-6) & (t < 1 + 1e-6))
    if not len(on): return np.array([np.argmin(np.hypot(*(points - a - d / 2).T))])
    return on[np.argsort(t[on])]


def square_stiffness(mu, c):
    """Of a bilinear square of the material strain = dev(stress)/(2 mu) + c trace(stress); its size plays no part."""
    law = np.array([[mu + 1 / (4 * c), 1 / (4 * c) - mu, 0], [1 / (4 * c) - mu, mu + 1 / (4 * c), 0], [0, 0, mu]])
    x, y = np.array([-1, 1, 1, -1]), np.array([-1, -1, 1, 1])
    total = np.zeros((8, 8))
    for s in np.array([-1, 1]) / np.sqrt(3):
        for t in np.array([-1, 1]) / np.sqrt(3):
            strain = np.zeros((3, 8))
            strain[0, ::2] = strain[2, 1::2] = x * (1 + y * t) / 2
            strain[1, 1::2] = strain[2, ::2] = y * (1 + x * s) / 2
            total += strain.T @ law @ strain / 4
    return total


def dissection(columns, rows):
    """Points of a lattice in an order with little fill: halves first, then what parts them."""
    parts = []

    def split(block):
        if block.size <= 16:
            parts.append(block.ravel())
            return
        if block.shape[1] < block.shape[0]: block = block.T
        middle = block.shape[1] // 2
        split(block[:, :middle])
        split(block[:, middle + 1:])
        parts.append(block[:, middle])

    split(np.arange(columns * rows).reshape(rows, columns))
    return np.concatenate(parts)


class Lattice:
    """A scenario on squares, CELLS per length."""

    def __init__(self, s, cells):
        low, high = np.min(s["outline"], 0), np.max(s["outline"], 0)
        self.columns, self.rows = np.round((high - low) * cells).astype(int)
        i, j = (a.ravel() for a in np.meshgrid(np.arange(self.columns), np.arange(self.rows)))
        first = j * (self.columns + 1) + i
        corners = np.stack([first, first + 1, first + self.columns + 2, first + self.columns + 1], 1)
        self.unknowns = np.stack([2 * corners, 2 * corners + 1], 2).reshape(-1, 8)
        centres = low + (np.stack([i, j], 1) + 0.5) / cells
        self.active = inside(centres, s["outline"])
        self.solid = self.active & np.any([inside(centres, p) for p in s["solid"]] + [np.zeros(len(i), bool)], 0)
        self.square = square_stiffness(s["mu"], s["c"])
        x, y = np.meshgrid(np.arange(self.columns + 1), np.arange(self.rows + 1))
        points = low + np.stack([x.ravel(), y.ravel()], 1) / cells
        self.count = 2 * len(points)
        fixed = np.zeros(self.count, bool)
        for support in s["supports"]:
            for a, b in support["segments"]:
                on = along(points, a, b)
                fixed[2 * on] |= support["x"]
                fixed[2 * on + 1] |= support["y"]
        self.loads = [(load["weight"], self.forces(load["tractions"], points)) for load in s["loads"]]
        used = np.zeros(self.count, bool)
        used[self.unknowns[self.active]] = True
        order = dissection(self.columns + 1, self.rows + 1)
        order = np.stack([2 * order, 2 * order + 1], 1).ravel()
        self.free = order[(used & ~fixed)[order]]

    def forces(self, tractions, points):
        force = np.zeros(self.count)
        for part in tractions:
            for a, b in part["segments"]:
                on = along(points, a, b)
                half = np.hypot(*np.diff(points[on], axis=0).T) / 2
                share = np.append(half, 0) + np.append(0, half) if len(on) > 1 else np.ones(1)
                share *= np.hypot(*np.subtract(b, a)) / share.sum()  # the whole force, where ends lie between points
                for c in (0, 1): np.add.at(force, 2 * on + c, share * part["traction"][c])
        return force

    def solve(self, stiffness):
        """Compliance, and what every square takes of it for stiffness 1."""
        values = np.outer(stiffness * self.active, self.square.ravel()).ravel()
        at = np.repeat(self.unknowns, 8, 1).ravel(), np.tile(self.unknowns, (1, 8)).ravel()
        matrix = sp.csc_matrix((values, at), (self.count, self.count))[self.free][:, self.free]
        factor = sl.splu(matrix, permc_spec="NATURAL", diag_pivot_thresh=0, options=dict(SymmetricMode=True))
        compliance, shares = 0.0, np.zeros(len(self.unknowns))
        for weight, force in self.loads:
            u = np.zeros(self.count)
            u[self.free] = factor.solve(force[self.free])
            compliance += weight * (force @ u)
            local = u[self.unknowns]
            shares += weight * np.einsum("ij,ij->i", local @ self.square, local)
        return compliance, shares

    def cone(self, radius):
        """Means over cones of that many cells, of active squares; and the transpose."""
        reach = np.arange(-int(radius), int(radius) + 1)
        kernel = np.maximum(0, radius - np.hypot(*np.meshgrid(reach, reach)))
        mask = self.active.reshape(self.rows, self.columns).astype(float)
        sums = lambda f: convolve(f.reshape(mask.shape) * mask, kernel, mode="constant").ravel()
        whole = np.maximum(sums(self.active.astype(float)), 1e-9)
        return lambda f: sums(f) / whole, lambda f: sums(f / whole) * self.active

    def at_points(self, density):
        """Means of the squares around every point."""
        sums = [np.zeros((self.rows + 1, self.columns + 1)) for _ in range(2)]
        for total, f in zip(sums, (density * self.active, self.active.astype(float))):
            f = f.reshape(self.rows, self.columns)
            for part in (total[1:, 1:], total[1:, :-1], total[:-1, 1:], total[:-1, :-1]): part += f
        return sums[0] / np.maximum(sums[1], 1)


class Trace:
    """Designs on the way; the clock stands still meanwhile."""

    def __init__(self, path):
        self.file, self.lost, self.states = open(path, "w"), 0.0, 0
        self.start = time.process_time()

    def add(self, lattice, density, compliance):
        now = time.process_time()
        self.states += 1
        field = lattice.at_points(density)
        self.file.write("%d %.9g %.6g %d %d %d\n" % (self.states, compliance, now - self.start - self.lost, self.states,
                                                     field.shape[1], field.shape[0]))
        np.savetxt(self.file, -field, fmt="%.5g")
        self.file.flush()
        self.lost += time.process_time() - now


def update(lattice, x, gain, volume, physical=lambda x: x):
    """Optimality criteria; `gain`: fall of the compliance over growth of the volume, per density."""
    root, wanted = np.sqrt(np.maximum(gain, 0)), volume * lattice.active.sum()
    low, high = 1e-9 * root.max(), 1e3 * root.max()
    while high - low > 1e-6 * (high + low):
        price = np.sqrt(low * high)
        new = np.clip(x * root / price, np.maximum(0, x - MOVE), np.minimum(1, x + MOVE)) * lattice.active
        new[lattice.solid] = 1
        low, high = (price, high) if physical(new).sum() > wanted else (low, price)
    return new


def plain(lattice, volume, x, radius, iterations, trace, penalty=lambda iteration: 3.0):
    mean, _ = lattice.cone(radius)
    for iteration in range(iterations):
        p = penalty(iteration)
        compliance, shares = lattice.solve(VOID + x**p * (1 - VOID))
        gain = mean(x * p * x**(p - 1) * shares) / np.maximum(x, 1e-3)
        new = update(lattice, x, gain, volume)
        change, x = abs(new - x).max(), new
        trace.add(lattice, x, compliance)
        if change < 0.01 and p == 3: break
    return x


def projected(lattice, volume, x, radius, sharpness, each, trace):
    mean, transposed = lattice.cone(radius)
    for beta in sharpness:
        whole = 2 * np.tanh(beta / 2)
        physical = lambda x: (np.tanh(beta / 2) + np.tanh(beta * (mean(x) - 0.5))) / whole * lattice.active
        for _ in range(each):
            rho = physical(x)
            compliance, shares = lattice.solve(VOID + rho**3 * (1 - VOID))
            slope = beta / np.cosh(beta * (mean(x) - 0.5))**2 / whole
            gain = transposed(3 * rho**2 * shares * slope) / np.maximum(transposed(slope * lattice.active), 1e-9)
            new = update(lattice, x, gain, volume, physical)
            change, x = abs(new - x).max(), new
            trace.add(lattice, physical(x), compliance)
            if change < 0.01: break


def main(scenario, cells, iterations, path, strong):
    trace = Trace(path)
    volume = scenario["volume"]
    lattice = Lattice(scenario, cells // 2 if strong else cells)
    start = np.where(lattice.solid, 1, volume * lattice.active)
    radius = lambda n: max(2.5, 0.03 * n)
    if not strong:
        plain(lattice, volume, start, radius(cells), iterations, trace)
        return
    growing = lambda i: min(3.0, 1 + 0.25 * (i // 5))
    x = plain(lattice, volume, start, radius(cells // 2), min(iterations, 60), trace, growing)
    finer = Lattice(scenario, cells)
    x = zoom(x.reshape(lattice.rows, lattice.columns), 2, order=0).ravel() * finer.active
    x[finer.solid] = 1
    projected(finer, volume, x, 4.5, (1, 2, 4, 8, 16, 32), 4, trace)


main(json.load(open(sys.argv[1])), int(sys.argv[2]), int(sys.argv[3]), sys.argv[4], "--strong" in sys.argv[5:])

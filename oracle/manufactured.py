"""Solutions with closed-form data (manufactured.csv, manufactured_loads.csv). The loads follow from u, theta and the
laws: f_0 from (2.3), q_0 from (2.4), tractions from (2.6); an extra traction and heat inflow on Gamma_C make
(2.8)-(2.10) exact.

u and theta are sums of T(t) P(x, y) with polynomials P (coefficients [i, j] of x^i y^j), so that space is exact.
"""

import numpy as np
from numpy.polynomial import polynomial as poly

from scheme import OPEN, STICK, Contact, Data, Mesh, Scheme, gauss

M, K, R = np.array([[[1.0, 0.3], [0.3, 0.8]], [[1.0, 0.2], [0.2, 0.7]], [[0.9, -0.4], [-0.4, 1.1]]])


def product(a, b):
    c = np.zeros((a.shape[0] + b.shape[0] - 1, a.shape[1] + b.shape[1] - 1))
    for (i, j), value in np.ndenumerate(a):
        c[i : i + b.shape[0], j : j + b.shape[1]] += value * b
    return c[:5, :5]                                                    # no degree here is above 4


def polynomial(terms):
    c = np.zeros((5, 5))
    for (i, j), value in terms.items():
        c[i, j] += value
    return c


ONE, X, Y = (polynomial({ij: 1}) for ij in [(0, 0), (1, 0), (0, 1)])
DOWN = ONE - Y                                                          # 1 - y, zero on Gamma_D
# T, T', T'' of the time factors.
LINEAR = (lambda t: t, lambda t: 1.0, lambda t: 0.0)
LINE = (lambda t: (t + 1), lambda t: 1.0, lambda t: 0.0)
DECAY = (lambda t: t * np.exp(-t), lambda t: (1 - t) * np.exp(-t), lambda t: (t - 2) * np.exp(-t))


def sine(a):
    return (lambda t: np.sin(a * t), lambda t: a * np.cos(a * t), lambda t: -a * a * np.sin(a * t))


HEAT = [((lambda t: 4 * np.sin(2 * t) + 4, lambda t: 8 * np.cos(2 * t)), product(product(X, ONE - X), DOWN))]
SLOPE = 0.1 * (product(X, Y) + X / 2 + ONE / 4)
WAVE = 0.1 * (product(X, X) / 2 + Y + ONE)
UY_B = [(DECAY, -0.1 * product(DOWN, product(X, Y))), (LINE, -0.05 * product(DOWN, X + ONE))]
UX_C = [(DECAY, 0.1 * product(DOWN, product(X, Y)))]
UY_C = [(sine(2), -0.1 * product(DOWN, Y)), (LINE, -0.1 * product(DOWN, 0.75 * ONE - X))]
BEND = product(DOWN, product(X - ONE / 4, X - ONE / 4))

# u_x for x < 1/4 and x > 1/4, u_y, theta, and c_nu, mu_tau, g, kbar, eps_c, theta_F.
SOLUTIONS = {
    "MS-P": ([(LINEAR, 0.3 * DOWN)], None, [(LINEAR, -0.2 * DOWN)], [], (100, 0.3, 0.0, 2, 0.5, 0.0)),
    "MS-A": ([(sine(2), 0.1 * product(DOWN, product(X, X) + Y / 2))], None, [(DECAY, product(DOWN, SLOPE))],
             HEAT, (0, 0.2, 0.0, 0, 1, 0.0)),
    "MS-B": ([(sine(1), product(DOWN, WAVE))], None, UY_B, HEAT, (100, 0.3, 0.01, 2, 0.5, 0.5)),
    "MS-C": (UX_C, [*UX_C, (sine(1), BEND)], UY_C, HEAT, (100, 0.3, 0.0, 2, 0.5, 0.5)),
    "MS-D": ([(sine(3), product(DOWN, WAVE))], None, UY_B, HEAT, (100, 0.3, 0.01, 2, 0.5, 0.5)),
}


class Exact:
    """The solution, its derivatives and the data that follow from it, at points of Omega."""

    def __init__(self, case):
        self.case = case
        self.left, right, self.uy, self.heat, laws = SOLUTIONS[case]
        self.right = self.left if right is None else right
        c_nu, mu_tau, g, kbar, eps_c, theta_F = laws
        self.data = Data(M, K, R, theta_F, c_nu, mu_tau, kbar, eps_c, g)

    def value(self, terms, p, t, dt=0, dx=0, dy=0):
        total = np.zeros(len(p))
        for time, c in terms:
            c = time[dt](t) * poly.polyder(poly.polyder(c, dx, axis=0), dy, axis=1)
            rows, columns = np.nonzero(c)
            c = c[: rows.max(initial=0) + 1, : columns.max(initial=0) + 1]         # few powers occur
            total += poly.polyval2d(p[:, 0], p[:, 1], c)
        return total

    def u(self, p, t, **order):
        ux = np.where(p[:, 0] < 0.25, self.value(self.left, p, t, **order), self.value(self.right, p, t, **order))
        return np.column_stack([ux, self.value(self.uy, p, t, **order)])

    def theta(self, p, t, **order):
        return self.value(self.heat, p, t, **order)

    def strain(self, p, t, dt=0, **order):
        dx, dy = order.pop("dx", 0), order.pop("dy", 0)
        gradient = np.stack([self.u(p, t, dt=dt, dx=dx + 1, dy=dy), self.u(p, t, dt=dt, dx=dx, dy=dy + 1)], axis=2)
        return (gradient + gradient.transpose(0, 2, 1)) / 2

    def stress(self, p, t, **order):
        """(2.1), or its derivative in space."""
        data, theta = self.data, self.theta(p, t, **order)
        strain, rate = self.strain(p, t, **order), self.strain(p, t, dt=1, **order)
        return data.elasticity(strain) + data.viscosity(rate) - theta[:, None, None] * M

    def body_force(self, p, t):
        """f_0 of (2.3)."""
        return self.u(p, t, dt=2) - self.stress(p, t, dx=1)[:, :, 0] - self.stress(p, t, dy=1)[:, :, 1]

    def source(self, p, t):
        """q_0 of (2.4)."""
        xx, xy, yy = (self.theta(p, t, **o) for o in ({"dx": 2}, {"dx": 1, "dy": 1}, {"dy": 2}))
        diffusion = K[0, 0] * xx + 2 * K[0, 1] * xy + K[1, 1] * yy
        return self.theta(p, t, dt=1) - diffusion - np.einsum("pij,ij->p", self.strain(p, t), R)

    def contact(self, p, t):
        """Extra traction and heat inflow on Gamma_C: what sigma nu and q nu lack of (2.8)-(2.10)."""
        data, nu = self.data, np.array([0.0, -1.0])
        r = -self.u(p, t)[:, 1] - data.g
        pressure = data.c_nu * np.maximum(r, 0)
        direction = np.sign(self.u(p, t, dt=1)[:, 0])
        if self.case == "MS-C":                                         # sticks for x < 1/4, with a chosen multiplier
            direction = np.where(p[:, 0] < 0.25, 7.2 * p[:, 0] - 0.9, direction)
        traction = self.stress(p, t) @ nu + np.column_stack([data.mu_tau * pressure * direction, -pressure])
        gradient = np.column_stack([self.theta(p, t, dx=1), self.theta(p, t, dy=1)])
        inflow = data.conductance(r) * (self.theta(p, t) - data.theta_F) + gradient @ K @ nu
        return traction, inflow


class Integrals:
    """Quadrature that is exact to degree 6, that of a squared error: 4 x 4 points per triangle, 4 per edge."""

    def __init__(self, mesh):
        s, weight = gauss(4)
        a, b = (v.ravel() for v in np.meshgrid(s, s))                   # the square folded onto the triangle
        self.shape = np.column_stack([1 - a - (1 - a) * b, a, (1 - a) * b])
        self.weight = mesh.area[:, None] * 2 * np.outer(weight, weight * (1 - s)).ravel()
        self.points = np.einsum("qa,cai->cqi", self.shape, mesh.x[mesh.cells]).reshape(-1, 2)
        self.mesh, self.s, self.edge_weight = mesh, s, weight / mesh.n

    def cells(self, values):
        """Integrals of values times the shape functions, at the nodes."""
        values = values.reshape(*self.weight.shape, -1)
        local = np.einsum("cq,cqk,qa->cak", self.weight, values, self.shape)
        total = np.zeros((len(self.mesh.x), values.shape[2]))
        np.add.at(total, self.mesh.cells, local)
        return total

    def edges(self, side, function):
        """The same over a side given by its nodes in a row."""
        first, second = side[:-1], side[1:]
        x, s = self.mesh.x, self.s[:, None]
        p = x[first][:, None] * (1 - s) + x[second][:, None] * s
        values = function(p.reshape(-1, 2)).reshape(len(first), len(s), -1)
        total = np.zeros((len(x), values.shape[2]))
        np.add.at(total, first, np.einsum("q,eqk->ek", self.edge_weight * (1 - self.s), values))
        np.add.at(total, second, np.einsum("q,eqk->ek", self.edge_weight * self.s, values))
        return total

    def norm(self, values):
        return np.sqrt((self.weight.ravel() * (values.reshape(self.weight.size, -1) ** 2).sum(1)).sum())


def loads(exact, integrals, t, t_source):
    """(f_n, v) with the tractions at t, and (q_0, eta) at t_source with the heat inflow at t."""
    mesh = integrals.mesh
    force = integrals.cells(exact.body_force(integrals.points, t))
    force += integrals.edges(mesh.left, lambda p: exact.stress(p, t) @ [-1.0, 0.0])
    force += integrals.edges(mesh.right, lambda p: exact.stress(p, t) @ [1.0, 0.0])
    force += integrals.edges(mesh.contact, lambda p: exact.contact(p, t)[0])
    source = integrals.cells(exact.source(integrals.points, t_source))
    source += integrals.edges(mesh.contact, lambda p: exact.contact(p, t)[1][:, None])
    return force.ravel(), source.ravel()


def errors(case, n, steps, points):
    """The errors of a row of manufactured.csv and the contact states at T."""
    exact, mesh = Exact(case), Mesh(n)
    integrals = Integrals(mesh)
    # The patch test takes q_0 at t_{n-1}, as (4.2) takes e there, so that the scheme's solution is the exact one.
    in_time = lambda t: loads(exact, integrals, t, t - 1 / steps if case == "MS-P" else t)
    scheme = Scheme(mesh, exact.data, steps, in_time, Contact(mesh, points))
    at = lambda values: np.einsum("qa,cak->cqk", integrals.shape, values.reshape(len(mesh.x), -1)[mesh.cells])
    basis, dofs, p = mesh.strain_basis(), mesh.dofs(), integrals.points
    start = exact.u(mesh.x, 0).ravel(), exact.u(mesh.x, 0, dt=1).ravel(), exact.theta(mesh.x, 0)    # interpolated
    rows, sizes = [], np.zeros(3)
    for t, u, w, theta in scheme.run(*start):
        sizes = np.maximum(sizes, scheme.sizes(u, w, theta))
        strain = np.repeat(np.einsum("caij,ca->cij", basis, u[dofs]), integrals.weight.shape[1], axis=0)
        rows.append([
            integrals.norm(at(w).reshape(-1, 2) - exact.u(p, t, dt=1)),
            integrals.norm(strain - exact.strain(p, t)),
            integrals.norm(at(theta).ravel() - exact.theta(p, t)),
            integrals.norm(at(u).reshape(-1, 2) - exact.u(p, t)),
        ])
    rows, state = np.array(rows), scheme.state
    names = ["w_H", "u_V", "th_L2", "u_H"]
    values = {f"{name}_max": value for name, value in zip(names, rows.max(0))}
    values |= {f"{name}_T": value for name, value in zip(names, rows[-1])}
    values["E_max_sum"] = rows[:, :3].sum(1).max()
    of_u, of_theta = scheme.round_off(sizes)
    parts = [of_u, of_u, of_theta, of_u]
    values["round_off"] = {f"{name}_{at}": part for name, part in zip(names, parts) for at in ("max", "T")}
    values["round_off"]["E_max_sum"] = sum(parts[:3])
    states = {"open": OPEN, "stick": STICK, "slip+": 1, "slip-": -1}
    return values | {name: np.sum(state == s) for name, s in states.items()}

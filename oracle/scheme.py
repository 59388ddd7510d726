"""Problem 4.1 on the unit square, written from docs/adr/0001-reading.md and the paper, without the Rust program.

P1 triangles; the mechanical step (4.1) by one semismooth Newton on the whole sparse system in (w_n, lambda); the heat
step (4.2) is linear, since phi_L(s) = s and u_n is known. Degrees of freedom: 2 i + c for u, i for theta at node i.
"""

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import LinearOperator, eigsh, splu

ONES, IDENTITY = np.ones((2, 2)), np.eye(2)


@dataclass
class Data:
    """Data of Problem 2.1; loads and foundation are those of section 5 unless replaced."""

    M: np.ndarray                   # thermal expansion tensor (2.1)
    K: np.ndarray                   # conductivity (2.2)
    R: np.ndarray                   # coupling (2.4)
    theta_F: float                  # temperature of the foundation (2.10)
    c_nu: float = 1e4               # p_nu(r) = c_nu r_+
    mu_tau: float = 0.2             # p_tau = mu_tau p_nu
    kbar: float = 1.0               # k_c(r) = kbar r / eps_c on [0, eps_c], kbar above
    eps_c: float = 1e-5
    g: float = 0.0                  # initial gap
    E: float = 2.0                  # (5.1), plane stress
    nu: float = 0.1
    mu_1: float = 10.0              # V tau = mu_1 tr(tau) I + mu_2 tau
    mu_2: float = 10.0

    def elasticity(self, e):
        """E e of (5.1)."""
        return self.E * self.nu / (1 - self.nu**2) * trace(e) * IDENTITY + self.E / (1 + self.nu) * e

    def viscosity(self, e):
        return self.mu_1 * trace(e) * IDENTITY + self.mu_2 * e

    def conductance(self, r):
        """k_c(r), with k_c(r) = 0 for r <= 0."""
        return self.kbar * np.clip(r / self.eps_c, 0, 1)


def trace(e):
    return np.trace(e, axis1=-2, axis2=-1)[..., None, None]


class Mesh:
    """n x n squares, each cut by its diagonal '/' (right) or '\\' (left)."""

    def __init__(self, n, diagonal="right"):
        self.n, m = n, n + 1
        x, y = np.meshgrid(np.arange(m) / n, np.arange(m) / n)
        self.x = np.column_stack([x.ravel(), y.ravel()])
        a = (np.arange(n)[:, None] * m + np.arange(n)).ravel()
        b, c, d = a + 1, a + m, a + m + 1
        cut = [(a, b, d), (a, d, c)] if diagonal == "right" else [(a, b, c), (b, d, c)]
        self.cells = np.concatenate([np.column_stack(t) for t in cut])
        p = self.x[self.cells]
        jacobian = np.stack([p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]], axis=2)
        self.area = np.linalg.det(jacobian) / 2
        inverse = np.linalg.inv(jacobian)
        self.grad = np.concatenate([-inverse.sum(1, keepdims=True), inverse], axis=1)   # of the shape functions
        self.contact = np.arange(m)                                                    # nodes of Gamma_C, y = 0
        left, right, top = np.arange(m) * m, np.arange(m) * m + n, np.arange(m) + n * m
        self.left, self.right = left, right
        nodes = np.arange(m * m)
        free = np.setdiff1d(nodes, top)                                                # V^h: v = 0 on Gamma_D, the top
        self.free_u = np.column_stack([2 * free, 2 * free + 1]).ravel()
        self.free_theta = np.setdiff1d(nodes, np.concatenate([top, left, right]))      # Q^h: 0 on Gamma_D and Gamma_N

    def strain_basis(self):
        """Strains of the six shape functions of a cell: (cell, 2 a + c, i, j)."""
        basis = np.zeros((len(self.cells), 6, 2, 2))
        for a in range(3):
            for c in range(2):
                basis[:, 2 * a + c, c, :] += self.grad[:, a, :] / 2
                basis[:, 2 * a + c, :, c] += self.grad[:, a, :] / 2
        return basis

    def dofs(self):
        return np.stack([2 * self.cells, 2 * self.cells + 1], axis=2).reshape(-1, 6)


def assemble(local, rows, columns, shape):
    i = np.broadcast_to(rows[:, :, None], local.shape)
    j = np.broadcast_to(columns[:, None, :], local.shape)
    return sp.csr_matrix((local.ravel(), (i.ravel(), j.ravel())), shape=shape)


class Forms:
    """The matrices of the forms (2.12)-(2.19) on V^h and Q^h, without boundary conditions."""

    def __init__(self, mesh, data):
        cells, dofs, nodes = mesh.cells, mesh.dofs(), len(mesh.x)
        e = mesh.strain_basis()
        area = mesh.area[:, None, None]

        def form(left, right):                                  # integral of left : right, both constant on cells
            return area * np.einsum("caij,cbij->cab", left, right)

        square = (2 * nodes, 2 * nodes)
        mass = area * (np.ones((3, 3)) + np.eye(3)) / 12
        self.C = assemble(mass, cells, cells, (nodes, nodes))   # (theta, eta)
        self.mass = sp.kron(self.C, sp.eye(2)).tocsr()          # (w, v)
        self.a = assemble(form(e, data.elasticity(e)), dofs, dofs, square)
        self.b = assemble(form(e, data.viscosity(e)), dofs, dofs, square)
        self.eps = assemble(form(e, e), dofs, dofs, square)     # (eps(u), eps(v))
        self.grad = assemble(area * np.einsum("cai,cbi->cab", mesh.grad, mesh.grad), cells, cells, (nodes, nodes))
        conduction = area * np.einsum("cai,ij,cbj->cab", mesh.grad, data.K, mesh.grad)
        self.d = assemble(conduction, cells, cells, (nodes, nodes))
        third = np.repeat(area / 3, 3, axis=2)                  # integral of a shape function
        pair = lambda tensor: np.einsum("caij,ij->ca", e, tensor)[:, :, None] * third
        self.m = assemble(pair(data.M), dofs, cells, (2 * nodes, nodes))        # m(theta, v) = v . m theta
        self.e = assemble(pair(data.R), dofs, cells, (2 * nodes, nodes)).T      # e(u, eta) = eta . e u


class Contact:
    """Points of Gamma_C with weights; rows of N: values of the trace at the points. nu = (0, -1), tau = (1, 0)."""

    def __init__(self, mesh, points=None):
        nodes, n = len(mesh.x), mesh.n
        if points is None:                                      # nodal quadrature
            self.weight = np.full(n + 1, 1 / n)
            self.weight[[0, n]] /= 2
            trace_ = sp.csr_matrix((np.ones(n + 1), (mesh.contact, mesh.contact)), (n + 1, nodes))
        else:                                                   # Gauss points on every edge
            s, weight = gauss(points)
            self.weight = np.tile(weight / n, n)
            first = np.repeat(np.arange(n), points)
            s, row = np.tile(s, n), np.arange(n * points)
            trace_ = sp.csr_matrix((np.r_[1 - s, s], (np.r_[row, row], np.r_[first, first + 1])), (n * points, nodes))
        self.theta = trace_
        self.normal = sp.kron(trace_, [[0.0, -1.0]]).tocsr()
        self.tangent = sp.kron(trace_, [[1.0, 0.0]]).tocsr()
        self.nodal = points is None


def gauss(points):
    s, weight = np.polynomial.legendre.leggauss(points)
    return (s + 1) / 2, weight / 2


# lambda = projection of lambda + c w_tau on |.| <= p_tau for every c > 0, so c changes the way of the iteration and not
# its limit: c is mu_2 times the first of these numbers, and the next one wherever a pattern comes back.
SCALES = (1.0, 4.0, 0.25, 16.0, 0.0625, 64.0)
# ||theta|| <= REACH / m_d times the norm of a heat flux on Gamma_C: (s_2^2 / lam_FP)^(1/2) of constants.csv.
REACH = 0.17
OPEN, STICK, SLIP = 0, 2, 1                                     # slip is +1 or -1, the sign of the slip velocity


class Scheme:
    """Problem 4.1. `loads(t)` gives the vectors of (f_n, v) and (q_0(t_n), eta)."""

    def __init__(self, mesh, data, steps, loads, contact=None, T=1.0):
        self.mesh, self.data, self.loads, self.steps, self.k = mesh, data, loads, steps, T / steps
        self.forms = Forms(mesh, data)
        self.contact = contact or Contact(mesh)
        f, free = self.forms, mesh.free_u
        self.K_u = (f.mass / self.k + f.b + self.k * f.a)[free][:, free]
        self.K_theta = (f.C / self.k + f.d)[mesh.free_theta][:, mesh.free_theta]
        self.N_nu, self.N_tau = self.contact.normal[:, free], self.contact.tangent[:, free]
        # With Gauss points more points may stick than there are nodes, and lambda is not unique: then the stick rows
        # are those of an augmented Lagrangian, w_tau = give (lambda - anchor), repeated until lambda rests.
        self.give = 0.0 if self.contact.nodal else 1 / (data.mu_2 * mesh.n)
        self.factors, self.heat = {}, (None, None)

    def run(self, u, w, theta):
        """Yields t_n, u_n, w_n, theta_n for n = 1 ... N."""
        multiplier, state = np.zeros(len(self.contact.weight)), None
        for n in range(1, self.steps + 1):
            force, source = self.loads(n * self.k)
            w, multiplier, state = self.mechanics(force, u, w, theta, multiplier, state)
            u_old, u = u, u + self.k * w
            theta = self.heat_step(source, u_old, u, theta)
            self.state, self.multiplier = state, multiplier
            yield n * self.k, u, w, theta

    def penetration(self, u):
        return self.contact.normal @ u - self.data.g

    def sizes(self, u, w, theta):
        """Norms of what the two half-steps solve for or are driven by, and the largest |theta - theta_F|."""
        f = self.forms
        strain = norm(f.eps, u)
        return max(norm(f.mass, w), strain), max(norm(f.C, theta), strain), np.abs(theta - self.data.theta_F).max()

    def round_off(self, sizes):
        """By how much two programs may differ by round-off, for the largest `sizes` of a run, to first order: a backward
        stable solve in each, and for heat the penetration through the slope of k_c; at most 1e-10 of the sizes (README)."""
        of_u, of_theta, difference = sizes
        eps = 2 * np.finfo(float).eps
        u = eps * condition(self.K_u) * of_u
        slope, m_d = self.data.kbar / self.data.eps_c, np.linalg.eigvalsh(self.data.K)[0]
        theta = eps * condition(self.K_theta) * of_theta + REACH / m_d * slope * difference * self.k * u
        return min(u, 1e-10 * of_u), min(theta, 1e-10 * of_theta)

    def factor(self, state):
        """The system in (w, lambda) for known open, stick and slip points: the tangent of Newton's method, factored."""
        key = state.tobytes()
        if key not in self.factors:
            if len(self.factors) > 3:
                self.factors.pop(next(iter(self.factors)))
            c, mu, W = self.data.c_nu, self.data.mu_tau, sp.diags(self.contact.weight)
            closed = sp.diags((state != OPEN) * 1.0)
            stick, slip = state == STICK, np.where(np.abs(state) == SLIP, state, 0)
            tangent = self.K_u + self.k * c * self.N_nu.T @ W @ closed @ self.N_nu
            rows = sp.diags(stick * 1.0) @ self.N_tau - sp.diags(slip * mu * c * self.k) @ self.N_nu
            own = sp.diags(np.where(stick, -self.give, 1.0))
            matrix = sp.bmat([[tangent, self.N_tau.T @ W], [rows, own]])
            self.factors[key] = splu(matrix.tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.01)
        return self.factors[key]

    def mechanics(self, force, u, w, theta, multiplier, state):
        """(4.1) with the friction bound at the unknown u_n, as an equation with the multiplier lambda_tau.
        It is piecewise linear in (w_n, lambda): a pattern that comes back from its own solution solves it exactly."""
        f, free, c, mu = self.forms, self.mesh.free_u, self.data.c_nu, self.data.mu_tau
        W, nodal, before = self.contact.weight, self.contact.nodal, self.penetration(u)
        right = (force + f.mass @ w / self.k - f.a @ u + f.m @ theta)[free]
        v, anchor, seen, scales = w[free], multiplier, set(), iter(SCALES)
        scale = next(scales)
        for _ in range(1000):
            if state is not None:
                stick, slip = state == STICK, np.where(np.abs(state) == SLIP, state, 0)
                first = right - self.N_nu.T @ (W * c * before * (state != OPEN))
                second = np.where(stick, -self.give * anchor, slip * mu * c * before)
                x = self.factor(state).solve(np.r_[first, second])
                v, multiplier = x[: len(free)], x[len(free) :]
            r = before + self.k * (self.N_nu @ v)                       # u_nu - g at t_n
            bound = mu * c * np.maximum(r, 0)                           # p_tau
            slip_velocity = self.N_tau @ v
            if nodal:
                test = multiplier + scale * self.data.mu_2 * slip_velocity
            else:
                test = anchor + slip_velocity / self.give
            new = np.where(r <= 0, OPEN, np.where(np.abs(test) <= bound, STICK, np.sign(test))).astype(np.int8)
            if state is not None and (new == state).all():
                if nodal or np.abs(multiplier - anchor).max() <= 1e-12 * np.abs(multiplier).max():
                    full = np.zeros_like(w)
                    full[free] = v
                    return full, multiplier, state
                anchor, seen = multiplier, set()
            if nodal and new.tobytes() in seen:                         # a cycle
                seen, scale = set(), next(scales, 1.0)
            state = new
            seen.add(state.tobytes())
        raise RuntimeError("Newton's method did not find the contact pattern of a step")

    def heat_step(self, source, u_old, u, theta):
        """(4.2): e at u_{n-1}, chi at u_n."""
        f, free, N = self.forms, self.mesh.free_theta, self.contact.theta
        weight = self.contact.weight * self.data.conductance(self.penetration(u))
        right = source + f.C @ theta / self.k + f.e @ u_old + N.T @ (weight * self.data.theta_F)
        if self.heat[0] is None or (self.heat[0] != weight).any():
            chi = (N.T @ sp.diags(weight) @ N)[free][:, free]
            self.heat = weight, splu((self.K_theta + chi).tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.01)
        new = np.zeros_like(theta)
        new[free] = self.heat[1].solve(right[free])
        return new


def condition(K):
    """Condition number of a symmetric positive definite matrix in the Euclidean norm, to about 1 %."""
    start = np.cos(np.arange(K.shape[0]) ** 2)
    inverse = LinearOperator(K.shape, splu(K.tocsc(), permc_spec="MMD_AT_PLUS_A").solve)
    extreme = [eigsh(a, 1, which="LA", v0=start, tol=1e-2, return_eigenvectors=False)[0] for a in (K, inverse)]
    return extreme[0] * extreme[1]


def norm(matrix, v):
    return np.sqrt(max(v @ (matrix @ v), 0.0))

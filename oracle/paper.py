"""The example of section 5: the solution at t = T (paper.csv) and the study of (5.2) (convergence.csv)."""

import numpy as np
import scipy.sparse as sp

from scheme import IDENTITY, ONES, OPEN, STICK, Data, Mesh, Scheme, norm

READINGS = {"MR": (ONES, IDENTITY, ONES), "identity": (IDENTITY,) * 3, "literal": (ONES,) * 3}   # M, K, R


def scheme(reading, theta_F, n, steps):
    """Section 5: f_0 = (0, -1), q_0 = 1, tractions (1.4, 0.4) on x = 0 and (-0.8, 0.4) on x = 1, zero initial data."""
    mesh = Mesh(n)
    M, K, R = READINGS[reading]
    problem = Scheme(mesh, Data(M, K, R, theta_F), steps, None)
    q = np.asarray(problem.forms.C.sum(axis=1)).ravel()
    f = np.column_stack([0 * q, -q])
    length = np.full(n + 1, 1 / n)
    length[[0, n]] /= 2
    f[mesh.left] += length[:, None] * [1.4, 0.4]
    f[mesh.right] += length[:, None] * [-0.8, 0.4]
    problem.loads = lambda t: (f.ravel(), q)
    return problem


def solve(problem):
    zero = np.zeros(len(problem.mesh.x))
    return problem.run(np.zeros(2 * len(zero)), np.zeros(2 * len(zero)), zero)


def summary(reading, theta_F, n, steps):
    """The quantities of a row of paper.csv by name."""
    problem = scheme(reading, theta_F, n, steps)
    for _, u, w, theta in solve(problem):
        pass
    mesh, forms, data, contact = problem.mesh, problem.forms, problem.data, problem.contact
    r = problem.penetration(u)
    p = data.c_nu * np.maximum(r, 0)
    ux, uy, wx, wy = u[0::2], u[1::2], w[0::2], w[1::2]
    e = mesh.strain_basis()
    strain = lambda v: np.einsum("caij,ca->cij", e, v[mesh.dofs()])
    s = data.elasticity(strain(u)) + data.viscosity(strain(w)) - theta[mesh.cells].mean(1)[:, None, None] * data.M
    s11, s22, s12 = s[:, 0, 0], s[:, 1, 1], s[:, 0, 1]
    values = {
        "displacement_min_x": ux.min(), "displacement_max_x": ux.max(),
        "displacement_min_y": uy.min(), "displacement_max_y": uy.max(),
        "velocity_max_x": np.abs(wx).max(), "velocity_max_y": np.abs(wy).max(),
        "temperature_min": theta.min(), "temperature_max": theta.max(),
        "von_mises_max": np.sqrt(s11**2 - s11 * s22 + s22**2 + 3 * s12**2).max(),
        "displacement_l2": norm(forms.mass, u), "displacement_v": norm(forms.eps, u),
        "velocity_l2": norm(forms.mass, w), "temperature_l2": norm(forms.C, theta),
        "force_x": -contact.weight @ problem.multiplier, "force_y": contact.weight @ p,
        "heat_flow": contact.weight @ (data.conductance(r) * (contact.theta @ theta - theta_F)),
        "penetration_max": r.max(), "pressure_max": p.max(),
        "open": np.sum(problem.state == OPEN), "stick": np.sum(problem.state == STICK),
        "slip": np.sum(np.abs(problem.state) == 1),
    }
    half = n // 2
    for name, node in {"00": 0, "h0": half, "10": n, "hh": half * (n + 1) + half}.items():
        values[f"ux_{name}"], values[f"uy_{name}"], values[f"theta_{name}"] = ux[node], uy[node], theta[node]
    return values


def study(reading, theta_F, levels, fine):
    """(5.2) with h = k = 1/n for n in `levels` against h = k = 1/fine: the three maxima and that of the sum, by level,
    and the round-off of each on the fine mesh."""
    problem = scheme(reading, theta_F, fine, fine)
    forms, points = problem.forms, problem.mesh.x
    coarse = {n: (interpolation(n, points), solve(scheme(reading, theta_F, n, n))) for n in levels}
    errors, sizes = {n: np.zeros(4) for n in levels}, np.zeros(3)
    for step, (_, u, w, theta) in enumerate(solve(problem), start=1):
        sizes = np.maximum(sizes, problem.sizes(u, w, theta))
        for n, (carry, steps) in coarse.items():
            if step * n % fine == 0:                                            # the coarse solution's own time levels
                _, u_n, w_n, theta_n = next(steps)
                carry_u = lambda v: (carry @ v.reshape(-1, 2)).ravel()
                now = [
                    norm(forms.mass, w - carry_u(w_n)),
                    norm(forms.eps, u - carry_u(u_n)),
                    norm(forms.C, theta - carry @ theta_n),
                ]
                errors[n] = np.maximum(errors[n], [*now, sum(now)])
    of_u, of_theta = problem.round_off(sizes)
    parts = [of_u, of_u, of_theta]
    return errors, [*parts, sum(parts)]


def interpolation(n, points):
    """Values of P1 functions of the mesh with n x n squares at points, exact since the meshes are nested."""
    m = n + 1
    corner = np.minimum((points * n).astype(int), n - 1)
    s, t = (points * n - corner).T
    node = corner[:, 1] * m + corner[:, 0]
    third = np.where(s >= t, node + 1, node + m)
    weights = np.column_stack([1 - np.maximum(s, t), np.abs(s - t), np.minimum(s, t)])
    columns = np.column_stack([node, third, node + m + 1])
    rows = np.repeat(np.arange(len(points)), 3)
    return sp.csr_matrix((weights.ravel(), (rows, columns.ravel())), (len(points), m * m))

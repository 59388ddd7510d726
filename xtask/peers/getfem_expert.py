"""The paper's square with matrices of GetFEM as an expert writes it: both matrices are factorized once, the contact is
solved on its 2 (n + 1) unknowns with the compliance K⁻¹ of Γ_C, and a step takes two solutions with each factor.

    python3 getfem_expert.py N STEPS MEASURED

Prints one JSON object: seconds of set-up and per step, Newton iterations, and extremes of the last step.
"""

import json
import resource
import sys
import time

import getfem as gf
import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from square import SIDES, square

C, MU, WIDTH = 1e4, 0.2, 1e-5


def matrix(mim, order, expression, *variables):
    """The second derivative of a form as a matrix of scipy."""
    spmat = gf.asm("generic", mim, 2, expression, -1, *variables)
    start, rows = spmat.csc_ind()
    whole = sp.csc_matrix((spmat.csc_val(), rows, start), shape=spmat.size())
    (first, last) = order
    return whole[first[0] : first[1], last[0] : last[1]].tocsc()


def main(n, steps, measured):
    begin = time.perf_counter()
    mesh, k = square(n), 1.0 / steps
    mfu, mft = gf.MeshFem(mesh, 2), gf.MeshFem(mesh, 1)
    for mf in (mfu, mft):
        mf.set_fem(gf.Fem("FEM_PK(2,1)"))
    mim = gf.MeshIm(mesh, gf.Integ("IM_TRIANGLE(4)"))
    nu, nt = mfu.nbdof(), mft.nbdof()
    fields = ("u", 1, mfu, np.zeros(nu), "t", 1, mft, np.zeros(nt))
    uu, tt = ((0, nu), (0, nu)), ((nu, nu + nt), (nu, nu + nt))
    eps = "(0.5*(Grad_u+Grad_u'))"
    mass = matrix(mim, uu, "u.Test_u", *fields)
    a = matrix(mim, uu, f"((2*0.1/(1-0.1*0.1))*Trace({eps})*Id(2)+(2/1.1)*{eps}):Grad_Test_u", *fields)
    b = matrix(mim, uu, f"(10*Trace({eps})*Id(2)+10*{eps}):Grad_Test_u", *fields)
    m = matrix(mim, ((0, nu), (nu, nu + nt)), "t*([1,1;1,1]:Grad_Test_u)", *fields)
    e = matrix(mim, ((nu, nu + nt), (0, nu)), "([1,1;1,1]:Grad_u)*Test_t", *fields)
    capacity = matrix(mim, tt, "t*Test_t", *fields)
    d = matrix(mim, tt, "Grad_t.Grad_Test_t", *fields)
    load = gf.asm("generic", mim, 1, "[0;-1].Test_u", -1, *fields)[:nu]
    for region, force in zip(SIDES, ("[1.4;0.4]", "[-0.8;0.4]")):
        load = load + gf.asm("generic", mim, 1, f"{force}.Test_u", region, *fields)[:nu]
    source = gf.asm("generic", mim, 1, "Test_t", -1, *fields)[nu:]
    at_u, at_t = mfu.basic_dof_nodes(), mft.basic_dof_nodes()
    free = np.flatnonzero(at_u[1] < 1 - 1e-9)
    warm = np.flatnonzero((at_t[1] < 1 - 1e-9) & (at_t[0] > 1e-9) & (at_t[0] < 1 - 1e-9))
    bottom = np.flatnonzero(at_t[1] < 1e-9)
    bottom = bottom[np.argsort(at_t[0][bottom])]
    # Degrees of freedom of Γ_C: of a vector field two per node, one after the other.
    by_place = {(round(x * n), round(y * n)): i for i, (x, y) in enumerate(at_t.T)}
    first = {by_place[(round(x * n), round(y * n))]: i for i, (x, y) in reversed(list(enumerate(at_u.T)))}
    tangent = np.array([first[i] for i in bottom])
    normal = tangent + 1
    weight = np.full(n + 1, 1 / n)
    weight[[0, n]] /= 2
    position = np.full(nu, -1)
    position[free] = np.arange(len(free))
    pn, pt = position[normal], position[tangent]
    options = {"permc_spec": "MMD_AT_PLUS_A", "diag_pivot_thresh": 0.0, "options": {"SymmetricMode": True}}
    ku = splu((mass / k + b + k * a)[free][:, free].tocsc(), **options)
    kt = splu((capacity / k + d)[warm][:, warm].tocsc(), **options)
    rows = np.r_[pn, pt]
    unit = np.zeros((len(free), len(rows)))
    unit[rows, np.arange(len(rows))] = 1.0
    compliance = ku.solve(unit)[rows]
    inner = np.isin(bottom, warm)
    pw = np.searchsorted(warm, bottom[inner])
    unit = np.zeros((len(warm), len(pw)))
    unit[pw, np.arange(len(pw))] = 1.0
    compliance_t = kt.solve(unit)[pw]
    setup = time.perf_counter() - begin
    u, w, theta = np.zeros(nu), np.zeros(nu), np.zeros(nt)
    lam, iterations = np.zeros(n + 1), 0
    begin = time.perf_counter()
    for _ in range(measured):
        right = load + mass @ (w / k) - a @ u + m @ theta
        start = ku.solve(right[free])
        before = -u[normal]
        v, lam, count = contact(start[rows], compliance, before, lam, weight, k, n)
        iterations += count
        r = before - k * v[: n + 1]
        # Forces on the body: the pressure pushes it up, friction against its slip.
        push = np.r_[weight * C * np.maximum(r, 0), -weight * lam]
        forces = np.zeros(len(free))
        forces[rows] = push
        w = np.zeros(nu)
        w[free] = start + ku.solve(forces)
        u_old, u = u, u + k * w
        conductance = (weight * np.clip(-u[normal] / WIDTH, 0, 1))[inner]
        right = source + capacity @ (theta / k) + e @ u_old
        start_t = kt.solve(right[warm])
        here = np.linalg.solve(np.eye(len(pw)) + compliance_t * conductance, start_t[pw])
        forces = np.zeros(len(warm))
        forces[pw] = -conductance * here
        theta = np.zeros(nt)
        theta[warm] = start_t + kt.solve(forces)
    per_step = (time.perf_counter() - begin) / measured
    print(
        json.dumps(
            {
                "setup": setup,
                "per_step": per_step,
                "iterations": iterations,
                "u_max": [u[first_of(at_u, n)].max(), u[first_of(at_u, n) + 1].max()],
                "u_min": [u[first_of(at_u, n)].min(), u[first_of(at_u, n) + 1].min()],
                "theta_max": theta.max(),
                "peak_memory_bytes": 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss,
            }
        )
    )


def first_of(at_u, n):
    """The first degree of freedom of each node of a vector field."""
    return np.arange(0, at_u.shape[1], 2)


def contact(free, compliance, before, lam, weight, k, n):
    """Velocities on Γ_C, normal ones first, and the friction stress, by semismooth Newton on the contact pattern."""
    half, state = n + 1, None
    for count in range(1, 200):
        v = free.copy() if state is None else v
        if state is not None:
            closed, stick = state[0], state[1]
            slip = np.where(closed & ~stick, state[2], 0)
            # v + compliance · F(v, λ) = free, F the forces against the velocities.
            matrix = np.zeros((3 * half, 3 * half))
            matrix[: 2 * half, : 2 * half] = np.eye(2 * half)
            pressing = weight * C * closed
            # p = C (before − k v_y) where closed, upwards.
            matrix[: 2 * half, :half] += compliance[:, :half] * (pressing * k)
            matrix[: 2 * half, 2 * half :] += compliance[:, half:] * weight
            right = np.r_[free + compliance[:, :half] @ (pressing * before), np.zeros(half)]
            for i in range(half):
                if stick[i]:
                    matrix[2 * half + i, half + i] = 1.0
                else:
                    matrix[2 * half + i, 2 * half + i] = 1.0
                    matrix[2 * half + i, i] = slip[i] * MU * C * k
                    right[2 * half + i] = slip[i] * MU * C * before[i]
            x = np.linalg.solve(matrix, right)
            v, lam = x[: 2 * half], x[2 * half :]
        r = before - k * v[:half]
        bound = MU * C * np.maximum(r, 0)
        test = lam + 10.0 * v[half:]
        new = (r > 0, (r > 0) & (np.abs(test) <= bound), np.sign(test))
        if state is not None and all((a == b).all() for a, b in zip(new[:2], state[:2])) and (
            (new[2] == state[2]) | ~new[0] | new[1]
        ).all():
            return v, lam, count
        state = new
    raise RuntimeError("the contact pattern was not found")


if __name__ == "__main__":
    main(*(int(argument) for argument in sys.argv[1:4]))

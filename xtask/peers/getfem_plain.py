"""The paper's square with GetFEM as its manual shows it: one model per half-step, Newton's method over the whole body in
every step, nothing reused.

    python3 getfem_plain.py N STEPS MEASURED

Prints one JSON object: seconds of set-up and per step, Newton iterations, and extremes of the last step.
"""

import json
import resource
import sys
import time

import getfem as gf
import numpy as np

from square import BOTTOM, SIDES, TOP, square


def main(n, steps, measured):
    begin = time.perf_counter()
    mesh, k = square(n), 1.0 / steps
    mfu, mft = gf.MeshFem(mesh, 2), gf.MeshFem(mesh, 1)
    for mf in (mfu, mft):
        mf.set_fem(gf.Fem("FEM_PK(2,1)"))
    mim, nodal = gf.MeshIm(mesh, gf.Integ("IM_TRIANGLE(4)")), gf.MeshIm(mesh, gf.Integ("IM_NC(2,1)"))
    mechanics = gf.Model("real")
    mechanics.add_fem_variable("w", mfu)
    mechanics.add_filtered_fem_variable("lam", mft, BOTTOM)
    for name in ("u0", "w0"):
        mechanics.add_initialized_fem_data(name, mfu, np.zeros(mfu.nbdof()))
    mechanics.add_initialized_fem_data("theta0", mft, np.zeros(mft.nbdof()))
    for name, value in (("k", k), ("c", 1e4), ("mu", 0.2), ("r", 10.0 * n)):
        mechanics.add_initialized_data(name, [value])
    strain = "(0.5*(Grad_{0}+Grad_{0}'))"
    stress = "((2*0.1/(1-0.1*0.1))*Trace({0})*Id(2)+(2/1.1)*{0})"
    total = strain.format("u0") + "+k*" + strain.format("w")
    mechanics.add_nonlinear_term(
        mim,
        f"(w-w0).Test_w/k + (10*Trace({strain.format('w')})*Id(2)+10*{strain.format('w')}):Grad_Test_w"
        f" + {stress.format('(' + total + ')')}:Grad_Test_w"
        " - theta0*([1,1;1,1]:Grad_Test_w) - [0;-1].Test_w",
    )
    mechanics.add_linear_term(mim, "-[1.4;0.4].Test_w", SIDES[0])
    mechanics.add_linear_term(mim, "-[-0.8;0.4].Test_w", SIDES[1])
    pressure = "(c*pos_part(-u0(2)-k*w(2)))"
    mechanics.add_nonlinear_term(nodal, f"-{pressure}*Test_w(2) + lam*Test_w(1)", BOTTOM)
    mechanics.add_nonlinear_term(
        nodal, f"(lam - max(min(lam+r*w(1), mu*{pressure}), -mu*{pressure}))*Test_lam/r", BOTTOM
    )
    mechanics.add_Dirichlet_condition_with_multipliers(mim, "w", 1, TOP)
    heat = gf.Model("real")
    heat.add_fem_variable("theta", mft)
    heat.add_initialized_fem_data("theta0", mft, np.zeros(mft.nbdof()))
    for name in ("u0", "u"):
        heat.add_initialized_fem_data(name, mfu, np.zeros(mfu.nbdof()))
    heat.add_initialized_data("k", [k])
    heat.add_linear_term(mim, "(theta-theta0)*Test_theta/k + Grad_theta.Grad_Test_theta - Test_theta")
    heat.add_linear_term(mim, "-([1,1;1,1]:Grad_u0)*Test_theta")
    heat.add_linear_term(nodal, "min(pos_part(-u(2))/1e-5,1)*theta*Test_theta", BOTTOM)
    for region in (TOP, *SIDES):
        heat.add_Dirichlet_condition_with_multipliers(mim, "theta", 1, region)
    setup = time.perf_counter() - begin
    begin, iterations = time.perf_counter(), 0
    for _ in range(measured):
        u0, w0 = mechanics.variable("u0"), mechanics.variable("w")
        mechanics.set_variable("w0", w0)
        done, _ = mechanics.solve("max_res", 1e-9, "max_iter", 100, "lsolver", "mumps")
        iterations += done
        u = u0 + k * mechanics.variable("w")
        heat.set_variable("theta0", mechanics.variable("theta0"))
        heat.set_variable("u0", u0)
        heat.set_variable("u", u)
        heat.solve("max_res", 1e-9, "lsolver", "mumps")
        mechanics.set_variable("u0", u)
        mechanics.set_variable("theta0", heat.variable("theta"))
    per_step = (time.perf_counter() - begin) / measured
    u, theta = mechanics.variable("u0").reshape(-1, 2), heat.variable("theta")
    print(
        json.dumps(
            {
                "setup": setup,
                "per_step": per_step,
                "iterations": iterations,
                "u_max": u.max(axis=0).tolist(),
                "u_min": u.min(axis=0).tolist(),
                "theta_max": theta.max(),
                "peak_memory_bytes": 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss,
            }
        )
    )


if __name__ == "__main__":
    main(*(int(argument) for argument in sys.argv[1:4]))

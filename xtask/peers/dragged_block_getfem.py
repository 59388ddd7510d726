"""The benchmark `pair-dragged-block` with GetFEM: integral contact with friction between nonmatching meshes.

    python3 dragged_block_getfem.py [R [REFINED]]

R is the augmentation parameter in N/m³; REFINED divides every cell. Prints, for each step, Newton's iterations and the
force on the block along and across the base, N/m.
"""

import sys

import getfem as gf
import numpy as np

TOP, BOTTOM = 2, 1


def body(x, y):
    mesh = gf.Mesh("cartesian Q1", x, y)
    for region, normal in ((BOTTOM, [0, -1]), (TOP, [0, 1])):
        mesh.set_region(region, mesh.outer_faces_with_direction(normal, 0.01))
    field = gf.MeshFem(mesh, 2)
    field.set_fem(gf.Fem("FEM_QK(2,1)"))
    return mesh, field, gf.MeshIm(mesh, gf.Integ("IM_GAUSS_PARALLELEPIPED(2,4)"))


def main(r=2.1e12, refined=1):
    gf.util("trace level", 0)
    gf.util("warning level", 0)
    cells = lambda start, end, n: np.linspace(start, end, n * refined + 1)
    base, block = body(cells(0, 0.06, 45), cells(0, 0.02, 15)), body(cells(0.02, 0.04, 20), cells(0.02, 0.04, 20))
    young, poisson, model = 210e9, 0.3, gf.Model("real")
    model.add_initialized_data("lambda", [young * poisson / (1 + poisson) / (1 - 2 * poisson)])
    model.add_initialized_data("mu", [young / 2 / (1 + poisson)])
    for name, (_, field, quadrature) in (("u1", block), ("u2", base)):
        model.add_fem_variable(name, field)
        model.add_isotropic_linearized_elasticity_brick(quadrature, name, "lambda", "mu")
        model.add_initialized_fem_data("before_" + name, field, np.zeros(field.nbdof()))
    model.add_initialized_data("top", [0.0, 0.0])
    model.add_Dirichlet_condition_with_multipliers(block[2], "u1", 1, TOP, "top")
    model.add_Dirichlet_condition_with_multipliers(base[2], "u2", 1, BOTTOM)
    for name, value in (("r", r), ("friction", 0.3), ("alpha", 1.0)):
        model.add_initialized_data(name, [value])
    model.add_filtered_fem_variable("traction", block[1], BOTTOM)
    model.add_integral_contact_between_nonmatching_meshes_brick(
        block[2], "u1", "u2", "traction", "r", "friction", BOTTOM, TOP, 1, "alpha", "before_u1", "before_u2"
    )
    for step in range(1, 21):
        t = step / 10
        model.set_variable("top", [2e-5 * max(t - 1, 0), -1e-5 * min(t, 1)])
        iterations, _ = model.solve(
            "max_res", 1e-9, "max_iter", 100, "lsolver", "mumps", "lsearch", "simplest", "alpha min", 1.0
        )
        for name in ("u1", "u2"):
            model.set_variable("before_" + name, model.variable(name))
        force = [gf.asm("generic", block[2], 0, f"traction({c})", BOTTOM, model) for c in (1, 2)]
        print(f"t = {t:.1f}: {iterations} iterations, {force[0]:.6e}, {force[1]:.6e}")


main(*(kind(word) for kind, word in zip((float, int), sys.argv[1:])))

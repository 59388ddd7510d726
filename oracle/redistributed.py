"""The bar that hits a wall with redistributed mass, by dense matrices: an independent program for `numerics redistributed`.

A bar of length 10 with E = 900, rho = 1 and N linear cells flies with v = -10 to a rigid wall 5 in front of it. Its
consistent mass matrix M loses the row and the column of the node in contact: M0 = P^T M P, where P gives that node the
velocity of the next one, and M_r = M0 o (1 + y Theta y^T) with y = (1, x) has the mass, centre and inertia of M. The node is in static balance at the end of each step, 0 <= p, u >= -5, p (u + 5) = 0; all others follow
the trapezoidal rule. Prints N, k and, at t = 1.5, the energy over 500, the rms of (p - 300)/300 over 0.55 < t < 1.1, the
mean velocity, and the displacements and velocities of both ends; the velocity of the node in contact is its mean over
the step.
"""

import sys

import numpy as np


def redistributed(mass, x):
    to_next = np.eye(len(x))
    to_next[0, :2] = [0.0, 1.0]
    moved = to_next.T @ mass @ to_next
    y = [np.ones_like(x), x]
    pairs = [(0, 0), (0, 1), (1, 1)]
    forms = [0.5 * (np.outer(y[r], y[s]) + np.outer(y[s], y[r])) for r, s in pairs]
    lost = [np.sum((mass - moved) * form) for form in forms]
    products = [[np.sum(moved * a * b) for b in forms] for a in forms]
    theta = np.linalg.solve(products, lost)
    return moved * (1.0 + sum(factor * form for factor, form in zip(theta, forms)))


def bar(cells, k, end=1.5):
    h, n = 10.0 / cells, cells + 1
    stiffness, mass = np.zeros((n, n)), np.zeros((n, n))
    for cell in range(cells):
        at = np.ix_([cell, cell + 1], [cell, cell + 1])
        stiffness[at] += 900.0 / h * np.array([[1.0, -1.0], [-1.0, 1.0]])
        mass[at] += h / 6.0 * np.array([[2.0, 1.0], [1.0, 2.0]])
    mass = redistributed(mass, np.linspace(-1.0, 1.0, n))
    # Rows of the others at the middle of the step, that of the contact node at its end; the unknown is the mean velocity.
    system = 2.0 / k * mass + k / 2.0 * stiffness
    system[0] = k * stiffness[0]
    free, held = np.linalg.inv(system), np.linalg.inv(system[1:, 1:])
    u, w = np.zeros(n), np.full(n, -10.0)
    errors = []
    for step in range(1, round(end / k) + 1):
        right = 2.0 / k * mass @ w - stiffness @ u
        x, p = free @ right, 0.0
        if u[0] + k * x[0] < -5.0:
            # The node stops at the wall.
            first = (-5.0 - u[0]) / k
            x = np.concatenate([[first], held @ (right[1:] - system[1:, 0] * first)])
            p = stiffness[0] @ (u + k * x)
        u, w = u + k * x, 2.0 * x - w
        w[0] = x[0]
        if 0.55 < step * k < 1.1:
            errors.append((p - 300.0) / 300.0)
    energy = 0.5 * w @ mass @ w + 0.5 * u @ stiffness @ u
    mean = np.ones(n) @ mass @ w / 10.0
    return energy / 500.0, float(np.sqrt(np.mean(np.square(errors)))), mean, u[0], u[-1], w[0], w[-1]


if __name__ == "__main__":
    sizes = [(int(n), float(k)) for n, k in (size.split(",") for size in sys.argv[1:])]
    for cells, k in sizes or [(100, 0.005), (400, 0.00125), (200, 0.01), (200, 0.000625)]:
        print(cells, k, *(f"{number:.15g}" for number in bar(cells, k)))

"""Korn, Friedrichs-Poincare and trace constants of the paper's square on a mesh (constants.csv), as eigenvalues."""

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import LinearOperator, eigsh, splu

from scheme import IDENTITY, ONES, Data, Forms, Mesh


def row(diagonal, n):
    """c_k: ||eps(v)|| >= c_k ||v|| on V^h in the norm (||v||^2 + ||eps(v)||^2)^(1/2); c_f likewise on Q^h with the
    gradient; s_1^2, s_2^2: largest ratios of the squared norm on Gamma_C to that of eps(v) and of grad theta."""
    mesh = Mesh(n, {"/": "right", "\\": "left"}[diagonal])
    forms = Forms(mesh, Data(ONES, ONES, ONES, 0.0))                    # d with all-ones K
    u, q = mesh.free_u, mesh.free_theta
    on_u = lambda matrix: matrix[u][:, u]
    on_q = lambda matrix: matrix[q][:, q]
    edge = sp.diags([np.r_[2.0, np.full(n - 1, 4.0), 2.0], np.ones(n), np.ones(n)], [0, 1, -1]) / (6 * n)
    trace = sp.block_diag([edge, sp.csr_matrix((len(mesh.x) - n - 1,) * 2)]).tocsr()          # (theta, eta) on Gamma_C
    both, tangential, normal = (sp.kron(trace, np.diag(c)).tocsr() for c in ([1, 1], [1, 0], [0, 1]))
    grad_u = sp.kron(forms.grad, IDENTITY).tocsr()

    korn = smallest(on_u(forms.eps), on_u(forms.mass))
    poincare = smallest(on_q(forms.grad), on_q(forms.C))
    return {
        "lam_eps_over_L2": korn,
        "c_k(paper norm)": np.sqrt(korn / (1 + korn)),
        "lam_eps_over_grad": smallest(on_u(forms.eps), on_u(grad_u)),
        "lam_eps_over_H1": smallest(on_u(forms.eps), on_u(grad_u + forms.mass)),
        "lam_FP": poincare,
        "c_f(H1 norm)": np.sqrt(poincare / (1 + poincare)),
        "lam_FP_K_ones": smallest(on_q(forms.d), on_q(forms.C)),
        "min_K_ones_over_grad": smallest(on_q(forms.d), on_q(forms.grad)),
        "s1^2": largest(on_u(both), on_u(forms.eps)),
        "s1n^2": largest(on_u(normal), on_u(forms.eps)),
        "s1t^2": largest(on_u(tangential), on_u(forms.eps)),
        "s2^2": largest(on_q(trace), on_q(forms.grad)),
    }


def largest(a, b):
    """Largest eigenvalue of a x = lambda b x, with b positive definite."""
    factor = splu(b.tocsc(), permc_spec="MMD_AT_PLUS_A")
    inverse = LinearOperator(b.shape, factor.solve)
    start = np.cos(np.arange(b.shape[0]))
    x = eigsh(a, 1, b, which="LA", Minv=inverse, v0=start)[1][:, 0]
    return (x @ (a @ x)) / (x @ (b @ x))                                # has more digits than the iteration's own value


def smallest(a, b):
    return 1 / largest(b, a)

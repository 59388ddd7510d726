"""Laws in Python: those of the paper, a law of its own, and faulty ones."""

import numpy as np

import amontons


class Compliance(amontons.NormalLaw):
    """p = c r₊."""

    def __init__(self, stiffness):
        self.stiffness = self.lipschitz = stiffness
        self.calls, self.points = 0, 0

    def pressure(self, at):
        self.calls, self.points = self.calls + 1, self.points + len(at)
        closed = at.penetration > 0
        return self.stiffness * np.maximum(at.penetration, 0.0), {"penetration": self.stiffness * closed}

    def energy(self, at):
        return 0.5 * self.stiffness * np.maximum(at.penetration, 0.0) ** 2


class Coulomb(amontons.FrictionLaw):
    """s = μ p."""

    def __init__(self, coefficient):
        self.coefficient = self.lipschitz = coefficient

    def bound(self, at):
        return self.coefficient * at.pressure, {"pressure": self.coefficient}


class Saturating(amontons.FrictionLaw):
    """s = τ tanh(μ p/τ)."""

    def __init__(self, coefficient, strength):
        self.coefficient = self.lipschitz = coefficient
        self.strength = strength

    def bound(self, at):
        tanh = np.tanh(self.coefficient * at.pressure / self.strength)
        return self.strength * tanh, {"pressure": self.coefficient * (1 - tanh**2)}


class Ramp(amontons.HeatLaw):
    """k_c = k̄ r/ε on [0, ε], with φ_L(s) = s."""

    def __init__(self, conductance, width):
        self.conductance_bound, self.width = conductance, width
        self.conductance_lipschitz = conductance / width

    def flux(self, at):
        r = at.penetration
        k = self.conductance_bound * np.clip(r / self.width, 0.0, 1.0)
        slope = np.where((r > 0) & (r < self.width), self.conductance_bound / self.width, 0.0)
        drop = at.temperature - at.foundation_temperature
        return k * drop, {"temperature": k, "foundation_temperature": -k, "penetration": slope * drop}


class Archard(amontons.WearLaw):
    def __init__(self, coefficient):
        self.coefficient_ = coefficient

    def coefficient(self, at):
        return self.coefficient_, {}


class Isotropic(amontons.MaterialLaw):
    """σ = λ tr(ε) I + 2μ ε in plane strain."""

    def __init__(self, young, poisson, dimension=2):
        self.mu = young / (2 * (1 + poisson))
        self.lam = young * poisson / ((1 + poisson) * (1 - 2 * poisson))
        identity = np.array([1.0, 1.0, 0.0, 1.0, 0.0, 0.0])
        self.map = self.lam * np.outer(identity, identity) + 2 * self.mu * np.eye(6)
        self.monotonicity, self.lipschitz = 2 * self.mu, 2 * self.mu + dimension * self.lam
        self.calls = 0

    def value(self, x, xi):
        self.calls += 1
        return xi @ self.map

    def tangent(self, x, xi):
        return self.map

    def potential(self, x, xi):
        return 0.5 * np.einsum("ij,ij->i", xi @ self.map, xi)


class Yielding(Isotropic):
    """σ = C ε + k ε/√(1 + ‖ε‖²/e²), with the potential k e² (√(1 + ‖ε‖²/e²) − 1): stiffer while strains are small."""

    def __init__(self, young, poisson, k, e):
        super().__init__(young, poisson, dimension=3)
        self.k, self.e = k, e
        self.lipschitz += k

    def root(self, xi):
        return np.sqrt(1.0 + np.sum(xi**2, axis=1) / self.e**2)

    def value(self, x, xi):
        return super().value(x, xi) + self.k * xi / self.root(xi)[:, None]

    def tangent(self, x, xi):
        root = self.root(xi)[:, None, None]
        return self.map + self.k * (np.eye(6) / root - xi[:, :, None] * xi[:, None, :] / (self.e**2 * root**3))

    def potential(self, x, xi):
        return super().potential(x, xi) + self.k * np.sum(xi**2, axis=1) / (self.root(xi) + 1.0)


class WrongSlope(Coulomb):
    def bound(self, at):
        return self.coefficient * at.pressure, {"pressure": 2 * self.coefficient}

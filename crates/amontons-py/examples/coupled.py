"""Two runs that exchange forces and displacements: the halves of a block, each its own run.

The right half gets the displacements of the interface and returns the forces that it takes; the left half gets the
opposite forces and returns the displacements. Each step is repeated until both agree, with the relaxation of Aitken.
The result is that of one run with the whole block.
"""

import numpy as np

import amontons

ACCEPTED = 1e-12
ITERATIONS = 100


def block(cells, conditions):
    """A block whose length is `cells`/4 m and whose sides are `left` and `right`."""
    return amontons.Case({
        "name": "block",
        "mesh": {"kind": "rectangle", "size": [cells / 4, 0.5], "n": [cells, 2]},
        "time": {"end": 0.2, "steps": 10},
        "material": {
            "density": 1000.0,
            "elasticity": {"law": "isotropic", "young": 1e6, "poisson": 0.3, "stress_state": "plane-strain"},
        },
        "boundary": conditions,
    })


HELD = {"on": "left", "displacement": [0, 0]}
PULLED = {"on": "right", "force": ["100*sin(20*t)", "-20*t"]}


def whole():
    """The displacements of the whole block at its right side after each step, a row per node."""
    with block(8, [HELD, PULLED]).stepping() as run:
        right, all = run.sides["right"], []
        while not run.is_done:
            all.append(run.step().fields["displacement"][right])
    return all


def halves():
    """The same of two halves that are coupled."""
    left = block(4, [HELD]).stepping()
    right = block(4, [HELD, PULLED]).stepping()
    all = []
    with left, right:
        interface = np.zeros((3, 2))
        while not left.is_done:
            saved = left.save(), right.save()
            relaxation, before = 0.5, None
            for _ in range(ITERATIONS):
                left.restore(saved[0])
                right.restore(saved[1])
                for component in range(2):
                    right.set_displacement("left", component, interface[:, component])
                right.step()
                left.set_force("right", -right.reactions("left"))
                moved = left.step().fields["displacement"][left.sides["right"]]
                difference = moved - interface
                if np.abs(difference).max() <= ACCEPTED * np.abs(moved).max():
                    break
                if before is not None:
                    change = difference - before
                    relaxation *= -np.sum(before * change) / np.sum(change * change)
                interface = interface + relaxation * difference
                before = difference
            else:
                raise RuntimeError(f"the halves differ by {np.abs(difference).max()} m after {ITERATIONS} iterations")
            all.append(right.state.fields["displacement"][right.sides["right"]])
    return all


if __name__ == "__main__":
    for at_end in halves():
        print(at_end.mean(axis=0))

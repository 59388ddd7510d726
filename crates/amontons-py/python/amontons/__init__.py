"""Contact of deformable bodies with friction and heat.

>>> import amontons
>>> result = amontons.run("paper.toml", mesh__n=16, time__steps=16)
>>> result.picture("deformed").save("paper.png")
"""

from ._amontons import __version__
from ._case import Case
from ._errors import (
    AmontonsError,
    CaseError,
    Fault,
    Interrupted,
    RequestError,
    ResultsError,
    RunError,
    SetupError,
    StepError,
    StudyError,
    ThreadsError,
    UnsoundError,
)
from ._laws import (
    FrictionLaw,
    HeatLaw,
    Law,
    LawError,
    MaterialLaw,
    NormalLaw,
    Points,
    WearLaw,
    check_law,
    mandel,
    tensors,
)
from ._result import Cells, Fields, Mesh, Picture, Result, Snapshot
from ._stepping import Saved, Stepping
from ._studies import Check, Study, Verification, benchmarks, check, converge, plot, run, verify
from ._sweep import sweep

__all__ = [
    "AmontonsError",
    "Case",
    "CaseError",
    "Cells",
    "Check",
    "Fault",
    "Fields",
    "FrictionLaw",
    "HeatLaw",
    "Interrupted",
    "Law",
    "LawError",
    "MaterialLaw",
    "Mesh",
    "NormalLaw",
    "Picture",
    "Points",
    "RequestError",
    "Result",
    "ResultsError",
    "RunError",
    "Saved",
    "SetupError",
    "Snapshot",
    "StepError",
    "Stepping",
    "Study",
    "StudyError",
    "ThreadsError",
    "UnsoundError",
    "Verification",
    "WearLaw",
    "__version__",
    "benchmarks",
    "check",
    "check_law",
    "converge",
    "mandel",
    "plot",
    "run",
    "sweep",
    "tensors",
    "verify",
]

"""Scalar fields with exactly the wanted minima and maxima, proven by an independent audit.

    >>> import numpy as np, morsmooth
    >>> x, y = np.mgrid[0:1:50j, 0:1:50j]
    >>> noisy = np.sin(9 * x) * y + 0.05 * np.sin(97 * x + 61 * y)
    >>> field = morsmooth.smooth(array=noisy, spacing=1 / 49, persistence="20%")

Meshes are data sets of PyVista or VTK, or pairs (points, cells); grids are plain arrays. A data set comes back as one of the same
library with new arrays, a plain array as a plain array. Every function works without the interpreter's lock; Ctrl-C ends a call at
once, and the work behind it at its next step. Everything that is raised is a :class:`morsmooth.Error`, for bad input also a
:class:`ValueError`.
"""

from ._errors import ContradictionError, Error, GuaranteeError, InputError, InternalError, NotOptimalWarning
from ._functions import (
    Fault,
    Pairs,
    Weights,
    deform,
    faults,
    geodesic,
    persistence_diagram,
    persistence_pairs,
    simplify,
    smooth,
    weights,
)
from ._native import __version__

__all__ = [
    "ContradictionError",
    "Error",
    "Fault",
    "GuaranteeError",
    "InputError",
    "InternalError",
    "NotOptimalWarning",
    "Pairs",
    "Weights",
    "__version__",
    "deform",
    "faults",
    "geodesic",
    "persistence_diagram",
    "persistence_pairs",
    "simplify",
    "smooth",
    "weights",
]

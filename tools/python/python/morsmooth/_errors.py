"""The exceptions. Their texts are those of the program, with its hints as further lines."""

from __future__ import annotations

from typing import Sequence


class Error(Exception):
    """Everything that morsmooth raises by itself.

    Attributes:
        message: what was found and what was expected.
        hints: what to do about it; may be empty.
    """

    def __init__(self, message: str = "", hints: Sequence[str] = ()):
        super().__init__("\n".join([message, *(f"hint: {hint}" for hint in hints)]))
        self.message = message
        self.hints = list(hints)

    def __reduce__(self):
        return type(self), (self.message, self.hints)


class InputError(Error, ValueError):
    """A mesh, an array or an option is not what it has to be (exit code 2 of the program)."""


class GuaranteeError(Error, RuntimeError):
    """A result was found, but the audit says that it has not what is promised (exit code 1 of the program)."""


class ContradictionError(GuaranteeError):
    """The handles of a deformation contradict each other: no shape without inversions has them."""


class InternalError(Error, RuntimeError):
    """A mistake in morsmooth itself; please report it."""


class NotOptimalWarning(UserWarning):
    """The result keeps its guarantee, but the solver stopped before it was proven optimal."""

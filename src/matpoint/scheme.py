"""Schemes: the order of a step's stages, and how velocities come back to the particles.

A scheme is a printed tuple of named stages. A stage says which equation it computes, what it
reads and what it writes; ``matpoint explain`` prints exactly what a step will do.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar

from matpoint.engine import Engine
from matpoint.errors import InputError
from matpoint.transfers import APIC, FLIP, FMPM, XPIC, Transfer

_FLIP = FLIP()


@dataclass(frozen=True)
class Stage:
    """One pass over the data.

    Attributes
    ----------
    name, equation
        What it does, in words and as a formula with its source.
    reads, writes
        The arrays.
    run
        Carries it out.
    """

    name: str
    equation: str
    reads: tuple[str, ...]
    writes: tuple[str, ...]
    run: Callable[[Engine], None]


LOCATE = Stage("locate", "cell and slab of x_p or x_a", ("position",), ("order",), Engine.locate)
CLEAR = Stage("clear", "m_i = 0, p_i = 0, f_i = 0", (), ("nodes",), Engine.clear)
GATHER = Stage(
    "particles to nodes",
    "m_i = sum phi m_p, p_i = sum phi m_p v_p,"
    " f_i = sum phi m_p b_p - grad phi . sigma_p V_p  (S 1, 2, 7, 9)",
    ("position", "velocity", "mass", "volume", "stress"),
    ("nodes",),
    Engine.gather,
)
GATHER_MOMENTUM = Stage(
    "momentum to nodes",
    "m_i = sum phi m_p, p_i = sum phi m_p v_p  (S 1, 2)",
    ("position", "velocity", "mass"),
    ("nodes",),
    Engine.gather_momentum,
)
AFFINE_OUT = Stage(
    "affine momentum to nodes",
    "p_i += sum phi m_p B_p D_p^-1 (x_i - x_p)  (Jiang et al. 2015)",
    ("position", "affine_moment", "mass"),
    ("nodes",),
    Engine.gather_affine,
)
SOLVE = Stage(
    "solve",
    "v_i = p_i / m_i, a_i = f_i / m_i, v_i+ = v_i + a_i dt  (S 5, 11, 12)",
    ("nodes",),
    ("nodes",),
    Engine.solve,
)
VELOCITY = Stage("velocity", "v_i = p_i / m_i  (S 2)", ("nodes",), ("nodes",), Engine.divide)
HOLD = Stage(
    "conditions", "v_i . n = given at both ends of the step", ("nodes",), ("nodes", "reaction"), Engine.hold
)
HOLD_START = Stage(
    "conditions at the start", "v_i . n = given at t", ("nodes",), ("nodes",), Engine.hold_start
)
HOLD_END = Stage(
    "conditions at the end", "v_i . n = given at t + dt", ("nodes",), ("nodes",), Engine.hold_end
)
_DEFORM = "F = (I + L_p dt) F, V = det F V0, sigma = law(F, L_p, dt, state)"
_DEFORMED = ("deformation_gradient", "volume", "stress", "state")
SCATTER = Stage(
    "nodes to particles and stress",
    "v_p += sum phi a_i dt, x_p+ = x_p + sum phi v_i+ dt, L_p = sum v_i+ grad phi  (S 13-15); " + _DEFORM,
    ("nodes", "position", "deformation_gradient", "state"),
    ("velocity", "position (next)", *_DEFORMED),
    Engine.scatter,
)
MOVE = Stage(
    "velocity and position to particles",
    "v_p += sum phi a_i dt, x_p+ = x_p + sum phi v_i+ dt  (S 13, 14)",
    ("nodes", "position"),
    ("velocity", "position (next)"),
    Engine.move,
)
AFFINE_BACK = Stage(
    "moment of velocity to particles",
    "B_p = sum phi v_i+ (x_i - x_p)^T  (Jiang et al. 2015)",
    ("nodes", "position"),
    ("affine_moment",),
    Engine.scatter_affine,
)
EXTEND = Stage(
    "extended velocity",
    "u_i = sum_{0 <= j < m} (1 - S+ S)^j v_i + a_i dt, S+ S from nodes to particles and back"
    "  (Hammerquist and Nairn 2017)",
    ("nodes", "position", "mass"),
    ("nodes", "reaction"),
    Engine.extend,
)
SCATTER_EXTENDED = Stage(
    "nodes to particles and stress",
    "v_p = sum phi u_i, x_p+ = x_p + sum phi v_i+ dt, L_p = sum v_i+ grad phi; " + _DEFORM,
    ("nodes", "position", "deformation_gradient", "state"),
    ("velocity", "position (next)", *_DEFORMED),
    Engine.scatter_extended,
)
MOVE_EXTENDED = Stage(
    "velocity and position to particles",
    "v_p = sum phi u_i, x_p+ = x_p + sum phi v_i+ dt",
    ("nodes", "position"),
    ("velocity", "position (next)"),
    Engine.move_extended,
)
FULL_MASS = Stage(
    "approximate full mass",
    "v_i+ = sum_{0 <= j < k} (1 - S+ S)^j v_i+, S+ S = M_L^-1 M  (Nairn and Hammerquist 2021)",
    ("nodes", "position", "mass"),
    ("nodes", "reaction"),
    Engine.invert_mass,
)
FULL_MASS_ONLY = Stage(
    "approximate full mass",
    "v_i = sum_{0 <= j < k} (1 - S+ S)^j v_i, S+ S = M_L^-1 M  (Nairn and Hammerquist 2021)",
    ("nodes", "position", "mass"),
    ("nodes",),
    Engine.invert_mass_only,
)
DEFORM = Stage(
    "velocity gradient and stress",
    "L_p = sum v_i grad phi  (S 15); " + _DEFORM,
    ("nodes", "position", "deformation_gradient", "state"),
    _DEFORMED,
    Engine.deform,
)
ADVANCE = Stage(
    "advance",
    "x_p = x_p+, and the domains with it  (S 16, 20)",
    ("position (next)", "deformation_gradient"),
    ("position", "domains"),
    Engine.advance,
)


@dataclass(frozen=True)
class Scheme(ABC):
    """Base of the schemes.

    Parameters
    ----------
    transfer
        How velocities come back: FLIP(blend), PIC(), APIC(), XPIC(order) or FMPM(order).
    """

    transfer: Transfer = _FLIP
    name: ClassVar[str]
    citation: ClassVar[tuple[str, ...]] = ("bardenhagen2002",)

    def __post_init__(self) -> None:
        if not isinstance(self.transfer, Transfer):
            raise InputError(
                f"scheme: transfer = {self.transfer!r}; FLIP(blend), PIC(), APIC(), XPIC(order) and"
                " FMPM(order) are allowed"
            )

    @property
    @abstractmethod
    def stages(self) -> tuple[Stage, ...]:
        """The stages of one step, in order."""

    def _with_transfer(self, *stages: Stage) -> tuple[Stage, ...]:
        """Give the stages that a transfer adds or puts in the place of others.

        APIC adds one after each gathering and after the velocities have come back; XPIC extends the
        velocity before it comes back, FMPM wherever velocities have been made.
        """
        other: dict[Stage, tuple[Stage, ...]] = {}
        match self.transfer:
            case APIC():
                other = {s: (s, AFFINE_OUT) for s in (GATHER, GATHER_MOMENTUM)}
                other |= {s: (s, AFFINE_BACK) for s in (SCATTER, MOVE)}
            case XPIC():
                other = {SCATTER: (EXTEND, SCATTER_EXTENDED), MOVE: (EXTEND, MOVE_EXTENDED)}
            case FMPM():
                other = {s: (s, FULL_MASS_ONLY) for s in (HOLD_START, HOLD_END)} | {HOLD: (HOLD, FULL_MASS)}
        return tuple(s for stage in stages for s in other.get(stage, (stage,)))


class USL(Scheme):
    """Update stress last (S, section 2)."""

    name: ClassVar[str] = "usl"

    @property
    def stages(self) -> tuple[Stage, ...]:
        return self._with_transfer(LOCATE, CLEAR, GATHER, SOLVE, HOLD, SCATTER, ADVANCE)


class USF(Scheme):
    """Update stress first, with the velocities at the start of the step."""

    name: ClassVar[str] = "usf"

    @property
    def stages(self) -> tuple[Stage, ...]:
        first = (LOCATE, CLEAR, GATHER_MOMENTUM, VELOCITY, HOLD_START, DEFORM)
        return self._with_transfer(*first, CLEAR, GATHER, SOLVE, HOLD, MOVE, ADVANCE)


class MUSL(Scheme):
    """Update stress last, with updated particle velocities mapped to the nodes once more."""

    name: ClassVar[str] = "musl"

    @property
    def stages(self) -> tuple[Stage, ...]:
        second = (CLEAR, GATHER_MOMENTUM, VELOCITY, HOLD_END, DEFORM, ADVANCE)
        return self._with_transfer(LOCATE, CLEAR, GATHER, SOLVE, HOLD, MOVE, *second)


#: Scheme name -> class.
SCHEMES: dict[str, type[Scheme]] = {s.name: s for s in (USL, USF, MUSL)}

"""Writers, and the triggers that say when they write."""

from __future__ import annotations

from matpoint.output.checkpoint import Checkpoint, resume
from matpoint.output.contract import Writer
from matpoint.output.curves import HistoryFigure
from matpoint.output.figures import ParticleFigure
from matpoint.output.folder import inside, prepare_folder
from matpoint.output.history import History, Probe, Recorder
from matpoint.output.progress import Progress
from matpoint.output.summary import Summary
from matpoint.output.triggers import AtTimes, EverySteps, EveryTime, Trigger
from matpoint.output.vtkhdf import VTKHDF

__all__ = [
    "VTKHDF",
    "AtTimes",
    "Checkpoint",
    "EverySteps",
    "EveryTime",
    "History",
    "HistoryFigure",
    "ParticleFigure",
    "Probe",
    "Progress",
    "Recorder",
    "Summary",
    "Trigger",
    "Writer",
    "inside",
    "prepare_folder",
    "resume",
]

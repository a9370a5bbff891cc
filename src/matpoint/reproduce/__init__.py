"""Every figure of a paper, in one folder, with the settings used."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from matpoint.reproduce.cpdi2 import reproduce_cpdi2
from matpoint.reproduce.imls import reproduce_imls
from matpoint.reproduce.tables import Announce

#: Name, as on the command line -> what makes the figures.
PAPERS: dict[str, Callable[[Path, Announce, bool], None]] = {
    "cpdi2": reproduce_cpdi2,
    "imls": reproduce_imls,
}

__all__ = ["PAPERS", "Announce"]

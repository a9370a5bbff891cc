"""The files that stand beside the figures of every paper."""

from __future__ import annotations

import json
import platform
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from matpoint._version import __version__
from matpoint.output.folder import claim

#: Told of what is being run.
Announce = Callable[[str], None]


def versions() -> dict[str, str]:
    """Return versions for ``settings.json``."""
    return {"matpoint": __version__, "python": platform.python_version()}


def write_all(
    out: Path, settings: Mapping[str, Any], results: Mapping[str, Any], lines: Sequence[str]
) -> None:
    """Write ``settings.json``, ``table.json`` and ``table.md`` into a folder that exists."""
    for name, content in (("settings.json", settings), ("table.json", results)):
        claim(out / name).write_text(json.dumps(content, indent=2) + "\n", encoding="utf-8")
    claim(out / "table.md").write_text("\n".join(lines), encoding="utf-8")

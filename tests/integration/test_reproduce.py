"""``matpoint reproduce`` as a user runs it."""

from __future__ import annotations

import json
import math
import subprocess
import sys

import pytest


@pytest.mark.slow
def test_reproduce_imls_draws_all_figures_and_reads_them(tmp_path):
    command = [sys.executable, "-m", "matpoint", "reproduce", "imls", "--quick"]
    done = subprocess.run(command, check=True, capture_output=True, text=True, cwd=tmp_path, timeout=600)
    out = tmp_path / "results" / "reproduce-imls"
    names = {path.name for path in out.glob("*.png")}
    assert names == {
        "figure-1-equal.png", "figure-2-corner.png", "figure-3-two.png", "figure-4-displacement.png",
        "figure-5-velocity.png", "figure-6-stress.png", "figure-size.png", "figure-cost.png",
    }  # fmt: skip
    assert all(path.stat().st_size > 5000 for path in out.glob("*.png"))
    table = json.loads((out / "table.json").read_text(encoding="utf-8"))
    settings = json.loads((out / "settings.json").read_text(encoding="utf-8"))
    assert settings["cells"] == [8, 16, 32]
    assert {"imls-as-coded", "imls-as-printed", "mls-raw", "spline-imls"} <= set(table)
    assert table["imls"][2]["velocity"] == pytest.approx(0.470, rel=0.02)
    assert table["spline-imls"][2]["velocity"] == pytest.approx(0.0717, rel=0.02)
    assert table["polynomials"]["figure-3-two.png"]["norms"][2] == 0.0
    known = {e["cells"]: e["velocity"] for e in table["imls"]}
    slope = math.log2(known[16] / known[32])  # 8 cells do not resolve the wave
    assert table["order"]["imls"]["velocity"] == pytest.approx(slope)
    text = (out / "table.md").read_text(encoding="utf-8")
    row = next(
        line for line in text.splitlines() if line.startswith("| imls |") and f"{known[16]:.3g}" in line
    )
    assert row.endswith(f"| {slope:.2f} |")
    assert f"fitted {slope:.2f}. On 32 cells" in text
    assert "An honest reading" in text
    assert text in done.stdout

"""Convergence studies: methods over cell sizes, in parallel processes, with results kept by content."""

from __future__ import annotations

from matpoint.study.converge import Study, converge
from matpoint.study.orders import fitted, neighbours, orders, tables

__all__ = ["Study", "converge", "fitted", "neighbours", "orders", "tables"]

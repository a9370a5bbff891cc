"""Convergence studies: methods over cell sizes, in parallel processes, with results kept by content."""

from __future__ import annotations

from matpoint.study.converge import Study, carry_out, converge
from matpoint.study.orders import fitted, neighbours, orders, tables
from matpoint.study.plan import Plan, plan

__all__ = ["Plan", "Study", "carry_out", "converge", "fitted", "neighbours", "orders", "plan", "tables"]

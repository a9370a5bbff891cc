"""Benchmarks for asv: ``asv run --config benchmarks/asv.conf.json``."""

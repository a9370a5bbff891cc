"""Compiled loops over plain arrays and scalars; they know nothing of matpoint's objects."""

"""``python -m matpoint``."""

from matpoint.cli import main

main()

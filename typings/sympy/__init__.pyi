# sympy has no types, and inferring them takes a checker many minutes: everything of it is Any.
from typing import Any

def __getattr__(name: str) -> Any: ...

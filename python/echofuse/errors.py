"""Bad input: what the command line reports in one line a problem, with exit status 2 and no traceback."""

from collections.abc import Sequence

__all__ = ["InputError", "TargetError", "problem"]


class InputError(Exception):
    """Unusable input. Each problem is one line that names the file, the key and what was expected."""

    def __init__(self, problems: str | Sequence[str]) -> None:
        lines = (problems,) if isinstance(problems, str) else tuple(problems)
        self.problems: tuple[str, ...] = tuple(" ".join(line.split()) for line in lines)
        super().__init__("\n".join(self.problems))


class TargetError(Exception):
    """A target that cannot be had or does not do its part: one line that says which, and why."""


def problem(file: object, key: str, expected: str, found: object = None) -> str:
    """Return ``FILE: KEY: expected ..., found ...``; an empty key or a `found` of None is left out."""
    where = f"{file}: {key}" if key else f"{file}"
    return f"{where}: expected {expected}" + ("" if found is None else f", found {_shortened(found)}")


def _shortened(found: object) -> str:
    text = found if isinstance(found, str) else repr(found)
    return text if len(text) <= 80 else text[:77] + "..."

"""What the columns of a file are, if a command line says so: tau=FILE."""

from __future__ import annotations

ROLES = ("q", "dq", "ddq", "tau", "current", "q_ref", "dq_ref", "ddq_ref")


def role_of(text: str) -> tuple[str, str]:
    """The role and the file of `tau=FILE`; no role for a file alone."""
    role, _, path = text.partition("=")
    return (role, path) if path and role in ROLES else ("", text)

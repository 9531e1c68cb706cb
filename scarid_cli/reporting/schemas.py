"""Render `schemas/*.json` as the page docs/tables.md."""

from __future__ import annotations

from scarid_cli.io import schemas

INTRODUCTION = """\
# Tables

Every command reads and writes tables of these kinds. `{i}` stands for the number of a joint, from
1. Units are those of revolute and of prismatic joints. The kinds are declared in `schemas/`, in
the Frictionless Table Schema, and checked at run time. This page is made by `make docs`.
"""


def page() -> str:
    """The whole page, one section per kind."""
    kinds = ("trajectory", "measurement", "motion", "parameters", "trace", "prediction", "metrics")
    return "\n".join([INTRODUCTION, *(section(schemas.load(kind)) for kind in (*kinds, "via"))])


def section(schema: schemas.TableSchema) -> str:
    """One kind of table."""
    lines = [
        f"## {schema.title} (`{schema.kind}`, version {schema.version})",
        "",
        schema.description,
        "",
        "| column | type | unit | required | what it is |",
        "|---|---|---|---|---|",
    ]
    for field in schema.fields:
        unit = " or ".join(field.units) or "-"
        needed = "yes" if field.required else "no"
        lines.append(f"| `{field.name}` | {field.type} | {unit} | {needed} | {field.description} |")
    return "\n".join([*lines, ""])


if __name__ == "__main__":
    print(page(), end="")  # noqa: T201

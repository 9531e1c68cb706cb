"""Render `schemas/*.json` as the page docs/tables.md."""

from __future__ import annotations

from collections.abc import Sequence

from scarid_cli.io import schemas

INTRODUCTION = """\
# Tables

The scarid commands read and write tables. For each kind of table this page says what a row is, and
lists the columns with their types and units. Equation numbers are those of the paper
([paper.md](paper.md)).

- `{i}` in the name of a column stands for the number of a joint: `q1`, `q2`, ... Joints are
  numbered from 1, without a gap.
- Where two units are given, the first is that of a revolute joint, and the second that of a
  prismatic joint.
- A required column must be present. A table may have columns that are not listed here: the commands
  that process samples pass them through unchanged.
- A number is a 64-bit floating-point number, and an integer has 64 bits.

Arrow and Parquet files keep the kind of a table, the robot, the units, the sampling period and the
history in their metadata, which `scarid info FILE` prints. A CSV file has no metadata: its kind is
detected from its columns. What the next command needs of the metadata stands in columns that only
CSV has, and that become metadata again where it is read: of a motion `passed_bandwidth` [Hz],
`passed_order` and `velocity_noise1` ... [rad/s or m/s], of a table of parameters `fitted_beside`,
JSON in its first row (the delay, and what was fitted beside the parameters). So a pipe ends in the
same estimates in any format.

The kinds are declared in `schemas/`, in the format of the Frictionless Table Schema. Commands check
what they read against these files, and `make docs` renders them as this page.
"""
TYPE_NAMES = {arrow: name for name, arrow in schemas.TYPES.items()}
# What writes a table of each kind, and what reads it, in the order of a pipe.
USES = {
    "via": ("you", "`trajgen --via`"),
    "trajectory": ("`trajgen`", "`simulate`"),
    "expected": ("`trajgen --expected`", "you"),
    "measurement": (
        "`simulate`, a real robot",
        "`resample`, `check`, `filter`, `tune`, `differentiate`, `identify`, `validate`",
    ),
    "trials": ("`tune`", "you"),
    "motion": ("`differentiate`", "`identify`, `validate`"),
    "parameters": (
        "`identify`",
        "`validate --parameters`, `compare`, `payload --parameters`, `gains --parameters`, "
        "`urdf --parameters`, `export --parameters`, `report`, `identify --initial`, "
        "`trajgen --after`",
    ),
    "trace": ("`identify --trace`", "`report`"),
    "metrics": ("`validate`", "`report`"),
    "comparison": ("`compare`", "you"),
    "payload": ("`payload`", "`report`"),
    "loads": ("`payload --trace`", "`report`"),
    "carried": ("`payload --trace`", "`plot`"),
    "gains": ("`gains`", "`identify --gains`"),
    "prediction": ("`validate --predictions`", "`report`"),
    "residual": ("`validate --residual`", "`plot`"),
    "published": ("you", "`report --published`"),
    "fleet": ("`make batch`", "`report --fleet`"),
    "estimates": ("`make batch`", "`report --fleet`"),
    "robots": ("`make batch`", "`report --fleet`"),
}


def page() -> str:
    """The whole page: an introduction, an overview, and one section for each kind."""
    kinds = [schemas.load(kind) for kind in USES]
    return "\n".join([INTRODUCTION, overview(kinds), *map(section, kinds)])


def overview(kinds: list[schemas.TableSchema]) -> str:
    """Which commands write and read each kind of table."""
    rows = [(f"[{kind.title}](#{_anchor(kind)})", *USES[kind.kind]) for kind in kinds]
    note = "`report` reads measurements, motions and parameters too, and `convert` reads any table."
    return "\n".join([*_table(("table", "written by", "read by"), rows), "", note, ""])


def section(schema: schemas.TableSchema) -> str:
    """One kind of table."""
    rows = [
        (
            f"`{field.name}`",
            TYPE_NAMES[field.type],
            " or ".join(field.units) or "-",
            "yes" if field.required else "no",
            field.description,
        )
        for field in schema.fields
    ]
    kind = f"Kind `{schema.kind}`, version {schema.version}."
    sampled = " Its rows are samples at a constant rate." if schema.sampled else ""
    table = _table(("column", "type", "unit", "required", "description"), rows)
    paragraphs = (f"## {schema.title}", schema.description, kind + sampled, "\n".join(table), "")
    return "\n\n".join(paragraphs)[:-1]


def _anchor(schema: schemas.TableSchema) -> str:
    return schema.title.lower().replace(" ", "-")


def _table(headers: tuple[str, ...], rows: Sequence[tuple[str, ...]]) -> list[str]:
    rule = "|".join(["---"] * len(headers))
    return [f"| {' | '.join(headers)} |", f"|{rule}|", *(f"| {' | '.join(row)} |" for row in rows)]


if __name__ == "__main__":
    print(page(), end="")  # noqa: T201

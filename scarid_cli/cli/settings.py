"""Files of settings: what `scarid tune` saves and `scarid differentiate --settings` takes."""

from __future__ import annotations

from pathlib import Path

from scarid_cli.errors import BadData

Settings = dict[str, dict[str, list[float]]]


def document(best: str, settings: Settings, origin: str) -> str:
    """TOML: the best method, and a table of settings, one value per joint, for each."""
    lines = [f"# {origin}", f'method = "{best}"']
    for method, values in settings.items():
        lines += ["", f"[{method}]"]
        lines += [f"{name} = [{', '.join(map(repr, v))}]" for name, v in values.items()]
    return "\n".join(lines) + "\n"


def read(path: str) -> tuple[str, Settings]:
    """The best method and the settings of each."""
    import tomllib

    try:
        content = tomllib.loads(Path(path).read_text("utf-8"))
        best = content.pop("method")
        settings = {
            method: {name: [float(x) for x in values] for name, values in table.items()}
            for method, table in content.items()
        }
    except FileNotFoundError:
        raise BadData(f"{path}: no such file; make one with `scarid tune --save`") from None
    except (AttributeError, KeyError, TypeError, ValueError):
        raise BadData(
            f"{path}: found no settings, expected a file as `scarid tune --save` makes it"
        ) from None
    return best, settings

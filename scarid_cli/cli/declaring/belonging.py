"""Options that mean nothing without another one, or say what an argument says."""

from __future__ import annotations

from scarid_cli.errors import UsageFault

FALSE_ALARMS = 1.0  # 1/h, unless --false-alarms says another rate


def needs(owner: str, value: object, given: dict[str, object]) -> None:
    """Refuse options (name: value, None where not given) of an owner that was not given."""
    for name, stated in given.items():
        if stated is not None and value is None:
            raise UsageFault(f"{name} belongs to {owner}, which was not given")


def the_robot(argument: str | None, option: str | None) -> str | None:
    """The robot that ROBOT or --robot names; both are refused."""
    if argument and option:
        raise UsageFault("the robot is given twice; leave out --robot")
    return argument or option

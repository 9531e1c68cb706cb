"""The text of a URDF with other bodies, as other programs read it."""

from __future__ import annotations

from xml.etree import ElementTree

import numpy as np
import pytest
from conftest import ROOT

from scarid_cli.io.urdf import Inertial, rewritten


@pytest.mark.parametrize("massive", [True, False])
def test_a_link_without_mass_says_so(*, massive: bool) -> None:
    """PyBullet gives a link without <inertial> 1 kg, so that the arm would be heavier."""
    text = (ROOT / "samples/arm.urdf").read_text()
    if not massive:
        tool = text[text.index('<link name="tool">') : text.rindex("</link>") + len("</link>")]
        text = text.replace(tool, '<link name="tool"/>')
    lower = Inertial(2.0, np.array([0.0, 0.0, -0.2]), 0.01 * np.eye(3))
    tree = ElementTree.fromstring(rewritten(text, {"lower": lower, "tool": None}, {}, "new"))
    masses = {
        link.get("name"): [float(mass.get("value", "")) for mass in link.iter("mass")]
        for link in tree.iter("link")
    }
    assert masses == {"base": [], "upper": [3.2], "lower": [2.0], "tool": [0.0]}
    moments = tree.find("link[@name='tool']/inertial/inertia")
    assert moments is not None
    assert {float(x) for x in moments.attrib.values()} == {0.0}
    assert len(moments.attrib) == 6

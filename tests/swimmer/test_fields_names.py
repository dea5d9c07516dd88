"""Fields that say one thing in two ways."""

import microswim as ms


def test_a_field_that_begins_alike_clears_nothing():
    """`tail.sections` is how sections stand, `tail.section` their half axes."""
    swimmer = ms.Swimmer.preset("tabak/helix-constant")
    sheared = swimmer.with_({"tail.sections": "sheared"})
    assert sheared.tail.radius == swimmer.tail.radius
    ribbon = swimmer.with_({"tail.section": (0.05, 0.02)})
    assert ribbon.tail.section == (0.05, 0.02)

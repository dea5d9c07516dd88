"""A field of the spec is said once: one line in its table, one in the part that holds it."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import microswim
from microswim.spec.tables import FIELDS

IN_THE_TABLE = '    dye: Annotated[Density, About("Dye", "made up", start=1.0)] = 0.0\n'
IN_THE_PART = "    dye: float = 0.0\n"
SEEN = """
from microswim.cli._over import axes, bounds
from microswim.cli.new import spec_text
from microswim.spec.readers import text
from microswim.spec.file import from_dict
from microswim.spec.toml import to_toml
from microswim.studies.sweeps.layout import said
from microswim.studio.page import snapshot
from microswim.studio.spec_tables import canonical
from microswim.studio.words import words
import microswim as ms

new = spec_text("helix", "um")
assert 'dye = "1000 kg/m^3"' in new and "# made up" in new, new
tables = text.toml(new, "new")
swimmer = from_dict(tables)
assert swimmer.fluid.dye == 1000.0
assert from_dict(tables, {"fluid.dye": "2 kg/L"}).numbers["fluid.dye"] == 2000.0
assert swimmer.with_({"fluid.dye": "3 kg/m^3"}).fluid.dye == 3.0
assert canonical(swimmer)["fluid"]["dye"] == "1000.0 kg/m^3"
assert from_dict(text.toml(to_toml(canonical(swimmer), "again"), "again")).fluid.dye == 1000.0
assert axes(("fluid.dye=1 g/cm^3:2 g/cm^3:2",), "SI")["fluid.dye"].round(6).tolist() == [1e3, 2e3]
assert bounds(("fluid.dye=1 kg/m^3:2 kg/m^3",), "SI", "--region")["fluid.dye"] == (1.0, 2.0)
assert said("fluid.dye", "SI") == {"units": "kg/m^3", "long_name": "Dye"}
dye = words()["fields"]["fluid.dye"]
assert (dye["kind"], dye["label"], dye["help"]) == ("quantity", "Dye", "made up")
assert '"fluid.dye": {"kind": "quantity", "label": "Dye"' in snapshot([{"tables": tables}])
assert ms.sweep(swimmer, {"fluid.dye": ["1 kg/m^3"]})["fluid.dye"].units == "kg/m^3"
for wrong in ("2 um", 2.0, "much"):
    try:
        from_dict(tables, {"fluid.dye": wrong})
    except ms.SpecError as error:
        assert "dye" in str(error)
    else:
        raise AssertionError(wrong)
try:
    from_dict(tables, {"fluid.dey": 1.0})
except ms.SpecError as error:
    assert 'did you mean "fluid.dye"?' in str(error), error
print("seen by all")
"""


def added(path, after, line):
    text = path.read_text(encoding="utf-8")
    assert text.count(after) == 1
    path.write_text(text.replace(after, after + line), encoding="utf-8")


def test_a_made_up_field_is_seen_by_every_door(tmp_path):
    package = tmp_path / "microswim"
    shutil.copytree(Path(microswim.__file__).parent, package)
    added(
        package / "swimmer" / "surroundings" / "fluid.py", "    density: float = 0.0\n", IN_THE_PART
    )
    added(package / "spec" / "tables.py", '    """[fluid]"""\n\n', IN_THE_TABLE)
    env = os.environ | {"PYTHONPATH": str(tmp_path)}
    command = [sys.executable, "-c", SEEN]
    done = subprocess.run(command, capture_output=True, text=True, env=env, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout == "seen by all\n"


def test_every_field_says_what_it_is():
    for field in FIELDS.values():
        assert field.about.label, field.path
        assert field.about.help, field.path

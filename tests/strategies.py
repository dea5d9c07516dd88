"""What may stand in a spec file, and much that may not, for tests that try it by thousands."""

import tomllib

from hypothesis import strategies as st

from microswim.spec import presets

VALID = [tomllib.loads(presets.read(name)) for name in presets.names(one_tail=True)]
FIELDS = sorted({f"{t}.{k}" for tables in VALID for t, table in tables.items() for k in table})
FIELDS += ["tail.wavelength", "tail.breaks", "tail.shape", "tail.sign", "tail.sections"]
FIELDS += ["interaction.coupling", "interaction.tail", "tail.surface_motion", "motion.free"]

UNITS = ["m", "um", "Hz", "rpm", "Pa s", "mPa s", "kg/m^3", "degC", "dB", "", "1/0", "%", "rad/s"]
words = st.sampled_from(
    ["helix", "plane_wave", "custom", "sphere", "spheroid", "ellipsoid", "none", "lighthill"]
    + ["cox", "constant", "all", "lab", "arc", "slender", "os:path", "os:", ":", "math:sin", "os"]
)
quantities = st.builds(lambda x, u: f"{x} {u}", st.floats() | st.integers(), st.sampled_from(UNITS))
scalars = st.one_of(
    st.floats(), st.integers(), st.booleans(), st.text(max_size=12), words, quantities
)
extremes = st.sampled_from([0, -1, 1, 1e-320, 1e308, -0.0, 10**400, 1e-9, 1e9])
values = st.recursive(
    scalars | extremes,
    lambda inner: (
        st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=4), inner, max_size=2)
    ),
    max_leaves=6,
)

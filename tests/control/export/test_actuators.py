"""Coils and magnets inside the exported model: its field is that of Python's, its steps too."""

import ctypes
import dataclasses

import fmpy
import numpy as np
import pytest
from fmpy.validation import validate_fmu

import microswim as ms
from microswim.control.export import compiler

RNG = np.random.default_rng(5)
DIPOLE = ms.DipoleField(moment=(4.0, 8.0, -2.0), position=(0.03, 0.01, 0.02))
COILS = """
Coil_List: [Left, Top coil]
Left:
  Source_List: [a, b]
  a:
    A_Coeff: [[2.0e-3], [1.0e-2], [0.3]]
    B_Coeff: [[1.0e-5], [-5.0e-7], [1.0e-8]]
    Source_Position: [[0.06], [0.0], [0.01]]
    Source_Direction: [[-1.0], [0.3], [0.0]]
  b:
    B_Coeff: [[2.0e-6]]
    Source_Position: [[-0.06], [0.0], [0.0]]
    Source_Direction: [[1.0], [0.0], [0.0]]
Top coil:
  Source_List: [a]
  a:
    B_Coeff: [[1.0e-5]]
    Source_Position: [[0.0], [0.06], [0.0]]
    Source_Direction: [[0.0], [-1.0], [0.0]]
"""


WINDINGS = """
[[coil]]
name = "east"
position = ["9 mm", "0 mm", "1 mm"]
axis = [-1, 0.1, 0.3]
diameter = "18 mm"
length = "5 mm"
thickness = "3 mm"
turns = 200
[[coil]]
position = ["0 mm", "-30 mm", "0 mm"]
axis = [0, 1, 0]
diameter = "50 mm"
turns = 80
"""
BODIES = {
    "block": ms.MagnetField(
        remanence=1.3, size=(0.02, 0.01, 0.03), position=(0, 0, 0.03), direction=(1, 2, -1)
    ),
    "cylinder": ms.MagnetField(
        remanence=1.1, shape="cylinder", size=(0.02, 0.03), position=(0.02, 0, 0),
        direction=(1, 0.5, 2),
    ),
    "sphere": ms.MagnetField(
        remanence=1.1, shape="sphere", size=(0.02,), position=(0.02, 0, 0), direction=(1, 0.5, 2)
    ),
}  # fmt: skip
#: Turned by a right angle about y.
TURNED = np.array([0.5**0.5, 0.0, 0.5**0.5, 0.0])


def table(path, n=7):
    axis = np.linspace(-0.004, 0.004, n)
    nodes = np.stack(np.meshgrid(axis, axis, 1.1 * axis, indexing="ij"), axis=-1).reshape(-1, 3)
    other = ms.DipoleField(moment=(1.0, 2.0, 5.0), position=(-0.03, 0.0, 0.0))
    lines = ["coil,x (m),y (m),z (m),Bx (T),By (T),Bz (T)"]
    for name, one in (("A", DIPOLE), ("B", other)):
        lines += [
            ",".join(map(repr, [name, *x.tolist(), *b.tolist()])).replace("'", "")
            for x, b in zip(nodes, one.at(0.0, nodes))
        ]
    path.write_text("\n".join(lines), encoding="utf-8")
    return str(path)


def fields(tmp_path, kind):
    if kind == "dipole":
        return DIPOLE, np.array([0.02, -0.03, 0.01, 3.0, 1.0, -2.0])
    if kind == "grid":
        return ms.CoilField(file=table(tmp_path / "grid.csv")), np.array([1.3, -0.4])
    if kind == "windings":
        (tmp_path / "coils.toml").write_text(WINDINGS, encoding="utf-8")
        field = ms.CoilField(file=str(tmp_path / "coils.toml"), currents=(0, 0))
        return field, np.array([2.0, -3.0])
    if kind in BODIES:
        place = np.array([0.025, -0.01, 0.01])
        moment = BODIES[kind].moment * [1, -1, 1]
        return BODIES[kind], np.append(place, moment if kind == "sphere" else TURNED)
    (tmp_path / "coils.yaml").write_text(COILS, encoding="utf-8")
    return ms.CoilField(file=str(tmp_path / "coils.yaml"), currents=(0, 0)), np.array([2.0, -3.0])


def at(field, numbers):
    """The field of the actuators' numbers in Python."""
    if isinstance(field, ms.DipoleField):
        return ms.DipoleField(position=tuple(numbers[:3]), moment=tuple(numbers[3:]))
    if isinstance(field, ms.CoilField):
        return field.at_currents(tuple(numbers))
    if field.shape == "sphere":
        return dataclasses.replace(field, position=tuple(numbers[:3]), direction=tuple(numbers[3:]))
    return _Turned(dataclasses.replace(field, position=tuple(numbers[:3])))


class _Turned:
    """A magnet after a right angle about y: the field of one whose places are turned back."""

    def __init__(self, field):
        turn = np.pi / 2.0
        self.field = dataclasses.replace(field, axis=(0, 1, 0), frequency=turn / (2.0 * np.pi))

    def at(self, _, place):
        return self.field.at(1.0, place)

    def gradient(self, _, place):
        return self.field.gradient(1.0, place)

    def felt(self, _, place):
        return self.field.felt(1.0, place)


def robot(field):
    return ms.Swimmer(
        body=ms.Sphere(radius=5e-4),
        tail=ms.HelicalTail(length=2e-3, amplitude=2e-4, waves=2, radius=1e-4, frequency=0.0),
        fluid=ms.Fluid(viscosity=0.34),
        coefficients=ms.GrayHancock(),
        magnet=ms.Magnet(moment=(1e-6, 3e-6, -1e-6)),
        field=field,
        units="SI",
    )


#: In the wire of the first coil: half of its diameter from its place, across its axis.
WITHIN = (0.009, 0.009 * 0.9486833, 0.001 - 0.009 * 0.3162278)
KINDS = ("dipole", "coils", "grid", "windings", *BODIES)
#: What agrees less well: the gradient of magpylib's fields is a difference of order 8.
LOOSE = dict.fromkeys(("windings", *BODIES), 1e-9)


@pytest.mark.parametrize(
    ("kind", "precision"),
    [(kind, "double") for kind in KINDS]
    + [(kind, "float") for kind in ("dipole", "coils", "grid", "windings")],
)
def test_c_makes_the_field_of_python_and_steps_in_it(tmp_path, kind, precision):
    field, numbers = fields(tmp_path, kind)
    one = ms.Stepper.of(robot(field), "rft", locked=True)
    _, source = compiler.write(ms.c_model(one, "robot", precision=precision), tmp_path)
    compiler.shared_library([source], tmp_path / "model.so")
    number = ctypes.c_double if precision == "double" else ctypes.c_float
    code = ctypes.CDLL(str(tmp_path / "model.so"))
    y, u, p = (number * 8)(), (number * 37)(), (number * 10)()
    code.robot_defaults(y, u, p)
    given = (number * len(numbers))(*numbers)
    exact = at(field, numbers)
    close = LOOSE.get(kind, 1e-11) if precision == "double" else 3e-4
    for place in RNG.uniform(-0.0039, 0.0039, (20, 3)):
        y[:3] = place
        assert code.robot_actuate(given, y, u) == 0
        B, J = exact.at(0.0, place), exact.gradient(0.0, place)
        assert np.array(u[7:10]) == pytest.approx(B, abs=close * np.abs(B).max())
        assert np.array(u[25:34]) == pytest.approx(J.ravel(), abs=close * np.abs(J).max())
        assert np.array(u[34:37]) == pytest.approx(place, rel=1e-6)
    state = ms.State.at([1e-3, -5e-4, 0])
    y[:] = state.values
    for _ in range(10):
        assert code.robot_actuate(given, y, u) == 0
        assert code.robot_step(p, u, number(0.02), y) == 0
        state = one.step(state, dt=0.02, **exact.felt(0.0, state.position))
    assert np.array(y) == pytest.approx(state.values, abs=1e-11 if precision == "double" else 1e-3)


@pytest.mark.parametrize(
    ("kind", "fmi"),
    [(kind, fmi) for kind in ("dipole", "coils", "grid") for fmi in ("2.0", "3.0")]
    + [("windings", "3.0"), ("block", "3.0")],
)
def test_the_fmu_has_them_as_inputs(tmp_path, kind, fmi):
    field, numbers = fields(tmp_path, kind)
    one, path = ms.Stepper.of(robot(field), "rft", locked=True), tmp_path / "robot.fmu"
    told = ms.export_fmu(one, path, name="robot", fmi=fmi)
    names = [n for n in told["variables"] if n.startswith(("current_", "magnet_"))]
    assert len(names) == len(numbers)
    assert not validate_fmu(str(path))
    drift = (1e-4, 0.0, -2e-4)
    found = fmpy.simulate_fmu(
        str(path), stop_time=0.2, step_size=0.02, output_interval=0.02,
        start_values={**dict(zip(names, numbers)), "field_x": drift[0], "field_z": drift[2]},
        output=["x", "y", "z"],
    )  # fmt: skip
    state, exact = ms.State.at(), at(field, numbers)
    for _ in range(10):
        felt = exact.felt(0.0, state.position)
        state = one.step(state, dt=0.02, **{**felt, "field": felt["field"] + drift})
    last = [float(found[-1][a]) for a in "xyz"]
    assert last == pytest.approx(state.position, rel=1e-9, abs=1e-15)


def test_coils_are_called_by_their_names(tmp_path):
    field, _ = fields(tmp_path, "coils")
    header = ms.c_model(ms.Stepper.of(robot(field), "rft", locked=True), "robot").header
    assert "current_Left [A], current_Top_coil [A]" in header


@pytest.mark.parametrize(("kind", "place"), [("grid", (0.1, 0.0, 0.0)), ("windings", WITHIN)])
def test_where_the_field_is_not_known_is_a_status(tmp_path, kind, place):
    field, numbers = fields(tmp_path, kind)
    one = ms.Stepper.of(robot(field), "rft", locked=True)
    _, source = compiler.write(ms.c_model(one, "robot"), tmp_path)
    compiler.shared_library([source], tmp_path / "model.so")
    code = ctypes.CDLL(str(tmp_path / "model.so"))
    code.robot_message.restype = ctypes.c_char_p
    y, u, p = (ctypes.c_double * 8)(), (ctypes.c_double * 37)(), (ctypes.c_double * 10)()
    code.robot_defaults(y, u, p)
    assert code.robot_actuate((ctypes.c_double * 2)(*numbers), y, u) == 0
    y[:3] = place
    status = code.robot_actuate((ctypes.c_double * 2)(*numbers), y, u)
    assert b"outside the grid, or in a winding" in code.robot_message(status)
    assert code.robot_actuate((ctypes.c_double * 2)(np.nan, 1.0), y, u) == 11


@pytest.mark.parametrize("kind", ["coils", "grid"])
def test_currents_for_a_field(tmp_path, kind):
    """Two coils make fields in a plane; what they cannot make is refused."""
    field, numbers = fields(tmp_path, kind)
    place = (1e-3, 0.0, -5e-4)
    wanted = field.at_currents(tuple(numbers)).at(0.0, place)
    assert field.currents_for(wanted, place) == pytest.approx(numbers, rel=1e-6)
    A = field.per_ampere(place)
    beyond = np.cross(A[:3, 0], A[:3, 1])
    with pytest.raises(ms.SpecError, match="coils can make"):
        field.currents_for(beyond / np.linalg.norm(beyond) * 1e-3, place)

"""Field output: what is written comes back, in meshio and in pyvista, at every moment of a run."""

import meshio
import numpy as np
import pytest
import pyvista

from fem.results.fields import FieldWriter, FrameFields, open_fields

POINTS = np.array([[x, z] for z in (0.0, 0.5, 1.0) for x in (0.0, 0.5, 1.0, 1.5, 2.0)])
QUADS = np.array([[0, 2, 12, 10], [2, 4, 14, 12]])
QUADS9 = np.array([[0, 2, 12, 10, 1, 7, 11, 5, 6], [2, 4, 14, 12, 3, 9, 13, 7, 8]])
RNG = np.random.default_rng(5)


def fields(floor=0.03):
    return {
        "displacement": RNG.normal(size=(15, 2)),
        "velocity": RNG.normal(size=(15, 2)),
        "von_mises": RNG.uniform(0.0, 3e8, size=15),
        "contact_pressure": RNG.uniform(0.0, 1e6, size=15),
        "floor_displacement": floor,
        "floor_lift": -0.5 * floor,
    }


def at(time, **values):
    return FrameFields(time=time, **values)


def writer(folder, cells=QUADS9, **options):
    return FieldWriter(
        folder, points=POINTS, cells=cells, region=np.array([1, 2]), box=np.array([1, 2]), **options
    )


@pytest.mark.parametrize(("cells", "kind"), [(QUADS, "quad"), (QUADS9, "quad9")])
def test_meshio_and_open_fields_read_what_was_written(tmp_path, cells, kind):
    written = fields(floor=-0.0125)
    mesh = meshio.read(writer(tmp_path, cells).write(at(0.25, **written)))
    assert mesh.cells[0].type == kind
    assert mesh.cells[0].data.tolist() == cells.tolist()
    assert mesh.points == pytest.approx(np.column_stack([POINTS, np.zeros(15)]), abs=1e-7)
    for name in ("displacement_m", "velocity_m_s"):
        assert (mesh.point_data[name].shape, mesh.point_data[name].dtype) == ((15, 3), np.float32)
        assert (mesh.point_data[name][:, 2] == 0.0).all()
    frame = open_fields(tmp_path).frame(0)
    assert frame.time == 0.25
    assert frame.points == pytest.approx(POINTS)
    assert frame.cells.tolist() == cells.tolist() and frame.region.tolist() == [1, 2]
    assert frame.box.tolist() == [1, 2]
    for name, wanted in written.items():
        assert getattr(frame, name) == pytest.approx(wanted, rel=1e-6)
    path = writer(tmp_path, cells).write(at(0.1, **written | {"von_mises": None}))
    assert "von_mises_Pa" not in meshio.read(path).point_data
    assert open_fields(tmp_path).frame(0).von_mises is None


@pytest.mark.parametrize(
    ("cells", "kind"), [(QUADS, pyvista.CellType.QUAD), (QUADS9, pyvista.CellType.BIQUADRATIC_QUAD)]
)
def test_pyvista_reads_the_time_series(tmp_path, cells, kind):
    out = writer(tmp_path, cells)
    written = [fields(), fields()]
    out.write(at(0.0, **written[0]))
    out.write(at(0.05, **written[1]))
    reader = pyvista.get_reader(tmp_path / "run.pvd")
    assert reader.time_values == [0.0, 0.05]
    reader.set_active_time_value(0.05)
    grid = reader.read()[0]
    assert set(grid.celltypes) == {kind}
    assert grid.field_data["TimeValue"].tolist() == [0.05]  # of a file that is opened alone
    assert grid.point_data["displacement_m"][:, :2] == pytest.approx(written[1]["displacement"], rel=1e-6)
    assert grid.cell_data["region"].tolist() == grid.cell_data["box"].tolist() == [1, 2]
    assert grid.compute_cell_sizes()["Area"] == pytest.approx([1.0, 1.0], rel=1e-6)  # nodes in VTK's order
    warped = grid.warp_by_vector("displacement_m")
    assert warped.points[:, :2] == pytest.approx(POINTS + written[1]["displacement"], abs=1e-6)


def test_meshio_reads_frames_whose_arrays_have_any_length(tmp_path):
    # meshio looks for arrays by offsets that it replaces one after the other, and may take one for another
    out = writer(tmp_path)
    written = []
    for quiet in range(100):
        moved = RNG.normal(size=(15, 2)) * (RNG.random((15, 1)) > quiet / 100)
        written.append(fields() | {"displacement": moved, "velocity": moved[::-1]})
        out.write(at(0.01 * quiet, **written[-1]))
    out.close()
    read = open_fields(tmp_path)
    for number, frame in enumerate(written):
        assert read.frame(number).displacement == pytest.approx(frame["displacement"], rel=1e-6)
        assert read.frame(number).contact_pressure == pytest.approx(frame["contact_pressure"], rel=1e-6)


def test_a_resumed_run_keeps_the_frames_up_to_there_and_no_others(tmp_path):
    out = writer(tmp_path)
    for i in range(4):
        out.write(at(i + 0.1 + 0.2, **fields()))
    again = writer(tmp_path, kept_times=out.times[:2])
    assert again.write(at(2.5, **fields())).name == "frame_00002.vtu"
    assert open_fields(tmp_path).times.tolist() == [0.1 + 0.2, 1.1 + 0.2, 2.5]  # to the last bit
    assert not (tmp_path / "frame_00003.vtu").exists()
    writer(tmp_path)  # a new run removes them all
    assert [p.name for p in tmp_path.iterdir()] == ["run.pvd"]


def test_a_series_that_names_files_elsewhere_or_is_damaged_is_refused(tmp_path):
    text = '<VTKFile><Collection><DataSet timestep="0" file="../secret.vtu"/></Collection></VTKFile>'
    (tmp_path / "run.pvd").write_text(text)
    with pytest.raises(ValueError, match="not in its folder"):
        open_fields(tmp_path)
    (tmp_path / "run.pvd").write_text(text[:-20])
    with pytest.raises(ValueError, match="damaged"):
        open_fields(tmp_path)

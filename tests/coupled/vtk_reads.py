#!/usr/bin/python3
"""Opens the field files of a coupled run with VTK's own readers and compares what they show with what is in the
files: points, cells, fields, and times where the reader has them. python3-vtk9 (VTK 9.1) knows files without steps,
so it shows the first one, and no particles; VTK 9.3 and later all. pvpython of ParaView 5.11 has the XDMF readers,
which show all. Needs no window. Exit code 77 where VTK is missing."""
import importlib
import os
import pathlib
import subprocess
import sys
import tempfile

try:
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkCommonCore import vtkVersion
    from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline as Pipeline
    from vtkmodules.vtkIOHDF import vtkHDFReader
except ImportError as error:
    print(f"skipped: VTK's readers are not installed (python3-vtk9): {error}")
    sys.exit(77)
import h5py
import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
VERSION = tuple(int(part) for part in vtkVersion().GetVTKVersion().split(".")[:2])
FILES = ("contact", "fem", "sph")
FIELDS = {"contact": {"contact_pressure", "contact_pressure_peak"}, "fem": {"displacement", "velocity", "stress"},
          "sph": {"id", "velocity", "pressure", "density"}}


def arrays(data):
    return {data.GetArrayName(k): vtk_to_numpy(data.GetArray(k)) for k in range(data.GetNumberOfArrays())}


def times_of(reader):
    reader.UpdateInformation()
    told = reader.GetOutputInformation(0)
    return [told.Get(Pipeline.TIME_STEPS(), k) for k in range(told.Length(Pipeline.TIME_STEPS()))]


def compare(reader, path, step):
    """What the reader shows of this step against the views of the file."""
    grid = reader.GetOutputDataObject(0)
    with h5py.File(path.with_suffix(".vtkhdf")) as file:
        view = file[f"Views/{step:05d}"]
        np.testing.assert_array_equal(vtk_to_numpy(grid.GetPoints().GetData()), view["Points"][:])
        shown = {**arrays(grid.GetPointData()), **arrays(grid.GetCellData())}
        held = {name: values[:] for group in ("PointData", "CellData") if group in view
                for name, values in view[group].items()}
    missing = (FIELDS[path.stem] | set(held)) - set(shown)
    assert not missing, f"{path.name}: {missing} not shown"
    for name, values in held.items():
        np.testing.assert_array_equal(shown[name].reshape(values.shape), values, err_msg=f"{path.name}: {name}")
    cells = grid.GetNumberOfCells()
    assert cells > 0, f"{path.name}: no cells"
    return f"{grid.GetNumberOfPoints()} points, {cells} cells, {', '.join(sorted(held))}"


def check(make, path, steps):
    """steps: of the file, or None where the reader knows only the first."""
    reader = make()
    reader.SetFileName(str(path))
    if steps is not None:
        times = times_of(reader)
        np.testing.assert_allclose(times, steps, rtol=1e-8, atol=1e-12, err_msg=f"{path.name}: times")
    for step in (0,) if steps is None else range(len(steps)):
        reader.UpdateTimeStep(steps[step]) if steps is not None else reader.Update()
        said = compare(reader, path, step)
    print(f"  {make.__name__} {path.name}: {'first state only' if steps is None else f'{len(steps)} times'}; {said}")


def main():
    with tempfile.TemporaryDirectory(prefix="undertow-") as folder:
        out = pathlib.Path(folder) / "results"
        top = HERE.parents[1]
        subprocess.run([top / "scripts/undertow", "run", top / "tests/restart/trio.toml", "--set", "time.end=0.04",
                        "--out", out, "--quiet"], check=True, stdout=subprocess.DEVNULL,
                       env={key: value for key, value in os.environ.items() if key not in ("LD_LIBRARY_PATH", "PYTHONPATH")})
        print("VTK", vtkVersion().GetVTKVersion())
        for name in FILES:
            with h5py.File(out / f"{name}.vtkhdf") as file:
                times = list(file["VTKHDF/Steps/Values"][:])
            assert len(times) > 5
            if VERSION >= (9, 3) or name != "sph":
                check(vtkHDFReader, out / f"{name}.vtkhdf", times if VERSION >= (9, 3) else None)
            for module, reader in (("vtkIOXdmf2", "vtkXdmfReader"), ("vtkIOXdmf3", "vtkXdmf3Reader")):
                try:
                    made = getattr(importlib.import_module("vtkmodules." + module), reader)
                except ImportError:
                    continue        # not in python3-vtk9
                check(made, out / f"{name}.xdmf", times)


if __name__ == "__main__":
    main()

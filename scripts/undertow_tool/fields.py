"""Field files: particles and meshes, step by step."""
import h5py
import numpy as np


class FieldFile:
    """A .vtkhdf file of a run, also of one that is still going."""

    def __init__(self, path):
        self.path = path
        with self._open() as file:
            self.times = np.array(file["VTKHDF/Steps/Values"], dtype=float)
            self.hexahedra = (np.array(file["Views/Hexahedra"], dtype=int)
                              if "Views/Hexahedra" in file else None)

    def _open(self):
        return h5py.File(self.path, "r")

    def __len__(self):
        return len(self.times)

    def nearest(self, t):
        """Index of the step nearest to time t [s]."""
        return int(np.argmin(np.abs(self.times - t)))

    def read(self, step, *fields):
        """Points (n, 3) and the named fields of a step; a field that is not there is None."""
        with self._open() as file:
            view = file[f"Views/{step:05d}"]
            found = []
            for name in fields:
                place = next((group for group in ("PointData", "CellData")
                              if f"{group}/{name}" in view), None)
                found.append(np.array(view[f"{place}/{name}"], dtype=float) if place else None)
            return (np.array(view["Points"], dtype=float), *found)


def open_fields(path):
    """A FieldFile, or None when there is none or it has no steps yet."""
    if not path.exists():
        return None
    fields = FieldFile(path)
    return fields if len(fields) else None

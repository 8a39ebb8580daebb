"""Field files: particles and meshes, step by step."""
import h5py
import numpy as np

NODES = {4: 3, 5: 4, 6: 4, 9: 8}       # of XDMF's triangles, quads, tetrahedra, hexahedra


def split_cells(mixed):
    """XDMF's stream of mixed cells (type, nodes, type, nodes, ...) -> {nodes of a cell: (cells' numbers, (n, nodes))}
    for solids and shells; what else there is (points, lines) is left out. A quad and a tetrahedron have four nodes each:
    keys are XDMF's types."""
    found, at, number = {}, 0, 0
    mixed = mixed.tolist()
    while at < len(mixed):
        kind = mixed[at]
        if kind in NODES:
            found.setdefault(kind, ([], []))
            found[kind][0].append(number)
            found[kind][1].append(mixed[at + 1:at + 1 + NODES[kind]])
            at += 1 + NODES[kind]
        elif kind in (1, 2):                # points and lines say how many nodes they have
            at += 2 + mixed[at + 1]
        else:
            break
        number += 1
    return {kind: (np.array(numbers), np.array(nodes)) for kind, (numbers, nodes) in found.items()}


class FieldFile:
    """A .vtkhdf file of a run, also of one that is still going."""

    def __init__(self, path):
        self.path = path
        with self._open() as file:
            self.times = np.array(file["VTKHDF/Steps/Values"], dtype=float)
            self.hexahedra = (np.array(file["Views/Hexahedra"], dtype=int)
                              if "Views/Hexahedra" in file else None)
            self.cells = ({9: (np.arange(len(self.hexahedra)), self.hexahedra)} if self.hexahedra is not None
                          else split_cells(np.array(file["Views/Cells"])) if "Views/Cells" in file else {})

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

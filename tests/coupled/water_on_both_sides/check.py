"""Two waters on both sides of a plate of 0.1 dx: each stands as if the other were not there."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import table  # noqa: E402


def check(results):
    weight = table.RHO_G * table.AREA * table.SURFACE
    bottom = table.RHO_G * table.SURFACE
    for z, p in zip(*table.layers(results / "sph.vtkhdf")):
        exact = table.RHO_G * ((table.PLATE if z < 0 else table.SURFACE) - z)
        # 2 %, of the bottom's pressure under the free surface, where the kernel has a gap
        assert abs(p - exact) < 0.02 * (exact if 0 < z < 0.06 or z < -0.06 else bottom), (
            f"layer at z = {z:.4f} m: {p:.1f} Pa, exact {exact:.1f} Pa")
    plate, under = (table.mean_force(results, face) for face in ("plate", "under"))
    assert abs(plate + weight) < 0.02 * weight, f"{plate:.3f} N on the upper face, {-weight:.3f} N"
    assert abs(under) < 0.02 * weight, f"{under:.3f} N on the lower face, which carries nothing"

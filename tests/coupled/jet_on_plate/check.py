"""A steady jet on a plate: what it pushes with, and no crowd along the plate."""
import json
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import table  # noqa: E402


def check(results):
    dx = json.loads((results / "case.json").read_text())["sph"]["spacing"]
    force = table.force(results)
    # 0.3 % at this spacing; 1.6 % without images, 6 % when particles had left the plane
    assert abs(force / table.FORCE - 1) < 0.01, f"{force:.3f} N instead of {table.FORCE:.3f} N"
    stagnation = table.stagnation(results, dx) - 1
    # 5 % low at a mirror plane as well
    assert abs(stagnation) < 0.1, f"stagnation pressure off by {stagnation:+.1%}"
    for k, (count, _, _, rms, _) in enumerate(table.layers(results, dx)):
        assert abs(count - 1) < 0.1, f"layer {k + 1} has {count:.2f} times its particles"
        assert rms < 0.1, f"layer {k + 1}: pressure off by {rms:.1%} of rho U^2/2 rms"

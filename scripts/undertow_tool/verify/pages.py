"""The table of docs/validation_sph.md, between its two marks; and what the terminal shows."""
import shutil

from rich.table import Table
from rich.text import Text

from ..errors import UserError
from ..paths import TOP, shown
from ..results_folder import read_json
from ..table import error_text, limit_text, number

PAGE = TOP / "docs" / "validation_sph.md"
IMAGES = TOP / "docs" / "images" / "verify_sph"
BEGIN, END = "<!-- verify: begin (written by scripts/undertow verify --docs) -->", "<!-- verify: end -->"


def row_state(row):
    """"ok", "FAILS" (also a known defect that has grown), "defect" (known), "mended" (known, but now within
    its gate), "-" (not judged)."""
    if row["ok"] is None:
        return "-"
    if row.get("defect"):
        return "mended" if row["ok"] else "FAILS" if row["worse"] else "defect"
    return "ok" if row["ok"] else "FAILS"


def state_text(state):
    return Text(state, {"ok": "green", "FAILS": "bold red", "defect": "yellow", "mended": "bold yellow"}.get(state, "dim"))


def ladder_table(result):
    """For the terminal."""
    table = Table(title=f"{result['name']}: {result['title']}", title_justify="left", title_style="bold")
    for column, justify in (("level", "left"), ("dx", "right"), ("particles", "right"), ("steps", "right"),
                            ("CPU s", "right"), ("wall s", "right"), ("M p-steps/CPU s", "right"), ("|drho|/rho", "right"),
                            ("momentum", "right"), ("quantity", "left"), ("ours", "right"), ("error", "right"),
                            ("allowed", "right"), ("", "left"), ("order", "right")):
        table.add_column(column, justify=justify, overflow="fold")
    for rung in result["rungs"]:
        f = rung["figures"]
        cells = [rung["label"], number(f["spacing"]), number(f["particles"]), number(f["steps"]), number(f["cpu_s"]),
                 number(f["wall_s"]), f"{1e-6 * f['particle_steps_per_cpu_s']:.2f}", number(f["max_density_deviation"]),
                 number(f["momentum_error"])]
        for row in f["checks"] or [None]:
            told = [row["name"], number(row["value"], row["unit"]), error_text(row), limit_text(row),
                    state_text(row_state(row)), number(result["orders"].get(row["name"]))] if row else [""] * 6
            table.add_row(*cells, *told)
            cells = [""] * len(cells)
    return table


def write_page(root):
    """Fills the block of docs/validation_sph.md from the results under root and copies the pictures."""
    text = PAGE.read_text()
    if BEGIN not in text or END not in text:
        raise UserError(f"{PAGE.name} has lost the marks between which the table is written: {BEGIN} and {END}.")
    IMAGES.mkdir(parents=True, exist_ok=True)
    lines = []
    for path in sorted(root.glob("*.json")):
        result = read_json(path)
        if result is None or "rungs" not in result:
            continue
        if not path.with_suffix(".png").exists():
            raise UserError(f"{shown(path)} is of a quick run without a picture: run `undertow verify {result['name']}` first.")
        shutil.copyfile(path.with_suffix(".png"), IMAGES / f"{result['name']}.png")
        lines += section(result)
    before, rest = text.split(BEGIN)
    PAGE.write_text(before + BEGIN + "\n" + "\n".join(lines) + "\n" + END + rest.split(END)[1])


def section(result):
    """Lines of Markdown about one verification."""
    lines = ["", f"### {result['name']}: {result['title']}", "", f"{result['exact']}", "",
             f"![error and cost](images/verify_sph/{result['name']}.png)", "",
             "| level | dx [m] | particles | steps | CPU [s] | M particle-steps/CPU s | density deviation | momentum error "
             "| quantity | ours | error | allowed | |",
             "|---|---|---|---|---|---|---|---|---|---|---|---|---|"]
    for rung in result["rungs"]:
        f = rung["figures"]
        cells = [rung["label"], number(f["spacing"]), number(f["particles"]), number(f["steps"]), f"{f['cpu_s']:.1f}",
                 f"{1e-6 * f['particle_steps_per_cpu_s']:.1f}", number(f["max_density_deviation"]), number(f["momentum_error"])]
        for row in f["checks"]:
            name = row["name"].replace("|", "\\|")      # Markdown's own mark of columns
            lines.append("| " + " | ".join(cells + [name, number(row["value"], row["unit"]), error_text(row),
                                                    limit_text(row), row_state(row)]) + " |")
            cells = [""] * len(cells)
    orders = [f"{name} {order:.1f}" for name, order in result["orders"].items() if order is not None]
    if orders:
        lines += ["", "Observed order: " + ", ".join(orders) + "."]
    if result.get("gates_from"):
        lines += ["", f"Gates: {result['gates_from']}"]
    for name, defect in result.get("defects", {}).items():
        lines += ["", f"**Known defect**, {name}: {defect['why']}"]
    return lines

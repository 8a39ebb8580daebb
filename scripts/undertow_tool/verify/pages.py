"""The tables of docs/validation_sph.md and docs/validation_fem.md, each between its two marks; and what the terminal shows."""
import shutil

from rich.table import Table
from rich.text import Text

from ..case import resolve
from ..errors import UserError
from ..paths import TOP, shown
from ..results_folder import read_json
from ..table import error_text, limit_text, number
from .closing_table import BEGIN as CLOSING_BEGIN, with_closing_table
from .ladder import known_verifications

PAGES = {solver: TOP / "docs" / f"validation_{solver}.md" for solver in ("sph", "fem")}
BEGIN, END = "<!-- verify: begin (written by scripts/undertow verify --docs) -->", "<!-- verify: end -->"
# Columns of a run's figures: title on the page, title in the terminal, key, factor.
COLUMNS = {
    "sph": (("dx [m]", "dx", "spacing", 1), ("particles", "particles", "particles", 1), ("steps", "steps", "steps", 1),
            ("CPU [s]", "CPU s", "cpu_s", 1),
            ("M particle-steps/CPU s", "M p-steps/CPU s", "particle_steps_per_cpu_s", 1e-6),
            ("density deviation", "|drho|/rho", "max_density_deviation", 1), ("momentum error", "momentum", "momentum_error", 1)),
    "fem": (("h [m]", "h", "spacing", 1), ("elements", "elements", "elements", 1), ("steps", "steps", "steps", 1),
            ("CPU [s]", "CPU s", "cpu_s", 1),
            ("M element-steps/CPU s", "M el-steps/CPU s", "element_steps_per_cpu_s", 1e-6),
            ("energy balance", "energy", "energy_balance_error", 1)),
}


def columns_of(result):
    return COLUMNS[result.get("solver", "sph")]


def cells_of(rung, columns):
    figures = rung["figures"]
    return [rung["label"]] + [number(figures[key] * factor if factor != 1 else figures[key]) for _, _, key, factor in columns]


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
    columns = columns_of(result)
    for column, justify in (("level", "left"), *((title, "right") for _, title, _, _ in columns), ("quantity", "left"),
                            ("ours", "right"), ("error", "right"), ("allowed", "right"), ("", "left"), ("order", "right")):
        table.add_column(column, justify=justify, overflow="fold")
    for rung in result["rungs"]:
        f, cells = rung["figures"], cells_of(rung, columns)
        for row in f["checks"] or [None]:
            told = [row["name"], number(row["value"], row["unit"]), error_text(row), limit_text(row),
                    state_text(row_state(row)), number(result["orders"].get(row["name"]))] if row else [""] * 6
            table.add_row(*cells, *told)
            cells = [""] * len(cells)
    return table


def write_pages(root):
    """Fills the block of each solver's page from the results under root and copies the pictures; the pages written."""
    results = [(path, read_json(path)) for path in sorted(root.glob("*.json"))]
    results = [(path, result) for path, result in results if result is not None and "rungs" in result]
    written = []
    for solver, page in PAGES.items():
        own = [(path, result) for path, result in results if result.get("solver", "sph") == solver]
        if own:
            write_page(page, own)
            written.append(page)
    return written


def sections_of(block):
    """{name: lines} of the verifications whose tables a block of a page has."""
    sections, name = {}, None
    for line in block.splitlines():
        if line.startswith("### "):
            name = line[4:].split(":")[0]
            sections[name] = [""]
        if name is not None:
            sections[name].append(line)
    return {name: lines[:-1] if lines[-1] == "" else lines for name, lines in sections.items()}


def write_page(page, results):
    """Tables of `results` take their places by name; those of other verifications that still exist stay."""
    text = page.read_text()
    if BEGIN not in text or END not in text:
        raise UserError(f"{page.name} has lost the marks between which the table is written: {BEGIN} and {END}.")
    before, rest = text.split(BEGIN)
    block, after = rest.split(END)
    known = known_verifications()
    sections = {name: lines for name, lines in sections_of(block).items() if name in known}
    for path, result in results:
        if not path.with_suffix(".png").exists():
            raise UserError(f"{shown(path)} is of a quick run without a picture: run `undertow verify {result['name']}` first.")
        images = TOP / "docs" / "images" / f"verify_{result.get('solver', 'sph')}"
        images.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(path.with_suffix(".png"), images / f"{result['name']}.png")
        sections[result["name"]] = section(result)
    lines = [line for name in sorted(sections) for line in sections[name]]
    text = before + BEGIN + "\n" + "\n".join(lines) + "\n" + END + after
    if CLOSING_BEGIN in text:
        text = with_closing_table(text, sections, {name: resolve(known[name], [])["report"] for name in sections})
    page.write_text(text)


def section(result):
    """Lines of Markdown about one verification."""
    columns = columns_of(result)
    titles = ["level", *(title for title, _, _, _ in columns), "quantity", "ours", "error", "allowed", ""]
    lines = ["", f"### {result['name']}: {result['title']}", "", f"{result['exact']}", "",
             f"![error and cost](images/verify_{result.get('solver', 'sph')}/{result['name']}.png)", "",
             "| " + " | ".join(titles) + " |", "|" + "---|" * len(titles)]
    for rung in result["rungs"]:
        f = rung["figures"]
        cells = cells_of(rung, columns)
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

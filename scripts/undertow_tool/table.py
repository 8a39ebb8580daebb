"""What the user reads at the end of a run."""
from rich.console import Console
from rich.table import Table
from rich.text import Text

from .paths import shown

ROOM_FOR_NOTES = 110        # [columns] a table in fewer has its notes below


def console(width=120):
    """On a pipe or in a log the table is not squeezed into 80 columns."""
    screen = Console(highlight=False)
    return screen if screen.is_terminal else Console(width=width, highlight=False)


def number(value, unit=""):
    if value is None:
        return "-"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, int):
        text = f"{value:,}"
    elif isinstance(value, float):
        size = abs(value)
        text = f"{value:.3g}" if (size < 1e-2 or size >= 1e5) and size > 0 else f"{value:.4g}"
    else:
        text = str(value)
    return f"{text} {unit}".strip()


def error_text(row):
    if row["error"] is None:
        return "-"
    if row.get("measure") == "relative":
        return f"{100 * row['error']:+.1f} %"
    return number(float(row["error"]), row["unit"])


def limit_text(row):
    if row.get("band"):
        return f"{number(row['band'][0])} to {number(row['band'][1])}"
    if row["tolerance"] is None:
        return "-"
    if row.get("measure") == "relative":
        return f"{100 * row['tolerance']:.3g} %"
    return number(float(row["tolerance"]), row["unit"])


def verdict(row):
    return {True: Text("yes", "green"), False: Text("NO", "bold red"), None: Text("-", "dim")}[row["ok"]]


def check_table(title, checks, notes=True):
    table = Table(title=title, title_justify="left", title_style="bold")
    columns = (("quantity", "left"), ("reference", "right"), ("ours", "right"), ("error", "right"), ("allowed", "right"),
               ("ok", "center"), ("note", "left"))[:7 if notes else 6]
    for column, justify in columns:
        table.add_column(column, justify=justify, overflow="fold")
    for row in checks:
        cells = (row["name"], number(row["reference"], row["unit"]), number(row["value"], row["unit"]), error_text(row),
                 limit_text(row), verdict(row), row["note"])
        table.add_row(*cells[:len(columns)])
    return table


def notes_below(checks):
    """Lines that stand for the column of notes: who has the same one shares a line."""
    told = {}
    for row in checks:
        if row["note"]:
            told.setdefault(row["note"], []).append(row["name"])
    return [f"  {'; '.join(names)}: {note}" for note, names in told.items()]


def comparison_table(summaries):
    """The same checks of several runs side by side. summaries: [(name, summary)]."""
    table = Table(title="comparison", title_justify="left", title_style="bold")
    table.add_column("quantity")
    table.add_column("reference", justify="right")
    for name, _ in summaries:
        table.add_column(name, justify="right")
    rows = []
    for _, summary in summaries:
        rows += [row["name"] for row in summary.get("checks", []) if row["name"] not in rows]
    for name in rows:
        cells, reference = [], "-"
        for _, summary in summaries:
            row = next((r for r in summary.get("checks", []) if r["name"] == name), None)
            if row is None:
                cells.append("-")
                continue
            reference = number(row["reference"], row["unit"])
            text = Text(number(row["value"], row["unit"]))
            if row["error"] is not None:
                text.append(f" ({error_text(row)})")
            text.stylize("red" if row["ok"] is False else "")
            cells.append(text)
        table.add_row(name, reference, *cells)
    for label, path in (("wall time [s]", ("wall_s",)), ("steps", ("steps",)),
                        ("particles", ("sph", "particles")), ("elements", ("fem", "elements"))):
        values = []
        for _, summary in summaries:
            value = summary
            for key in path:
                value = value.get(key) if isinstance(value, dict) else None
            values.append(number(value))
        table.add_row(Text(label, "dim"), "", *values)
    return table


def shares(limiters, most=4):
    """{"sph: sound": 0.932, ...} (fractions or counts) as text, the largest first."""
    total = sum(limiters.values()) or 1
    ordered = sorted(limiters.items(), key=lambda item: -item[1])
    text = ", ".join(f"{name.replace(' # ', ' ')} {100 * value / total:.0f} %"     # of any number
                     for name, value in ordered[:most] if value > 0)
    return text + (", ..." if len(ordered) > most else "")


def physics(sph, fem):
    """What the run computed, in the figures by which one sees whether it can be right."""
    fluid = [f"{label} {sph[key] * factor:.3g}{unit}" for label, key, factor, unit in
             (("fastest", "max_speed", 1, " m/s"), ("density within", "max_density_deviation", 100, " %")) if key in sph]
    fluid += [f"{sph[key]:,} {words}" for key, words in (("removed", "removed"), ("put_back_behind_walls", "put back behind walls"))
              if sph.get(key)]
    lines = ["fluid: " + ", ".join(fluid)] if fluid else []
    if "max_displacement" in fem:
        lines.append(f"structure: largest displacement {number(float(fem['max_displacement']), 'm')}")
    return lines


def figures(summary):
    """The run's own figures, a line per idea; what a program did not report is left out."""
    sph, fem, coupling = (summary.get(k) or {} for k in ("sph", "fem", "coupling"))
    lines = [f"wall time {number(summary.get('wall_s'), 's')}"]
    if summary.get("steps") is not None:
        lines[0] += f", {number(summary['steps'])} steps"
    steps = [f"{name} {summary[key]:.3g} s" for name, key in (("mean", "dt_mean"), ("least", "dt_min"))
             if isinstance(summary.get(key), (int, float))]
    limiters = summary.get("limiters")
    if steps:
        lines.append("dt " + ", ".join(steps)
                     + (f"; limited by {shares(limiters)}" if isinstance(limiters, dict) and limiters else ""))
    for part, what, rate in ((sph, "particles", "particle_steps_per_s"), (fem, "elements", "element_steps_per_s")):
        if what in part:
            text = f"{number(part[what])} {what}"
            if part.get(rate):
                text += f", {part[rate] / 1e6:.3g} M {rate.split('_')[0]}-steps/s"
            if part.get("threads"):
                text += f" on {part['threads']} thread" + ("s" if part["threads"] != 1 else "")
            lines.append(text)
    lines += physics(sph, fem)
    told = [f"{label} {100 * coupling[key]:.1f} %" for label, key in
            (("overhead", "overhead_fraction"), ("SPH waited", "sph_wait_fraction"),
             ("FEM waited", "fem_wait_fraction"))
            if isinstance(coupling.get(key), (int, float))]
    if coupling.get("bytes_per_step") is not None:
        told.append(f"{coupling['bytes_per_step'] / 1024:.3g} KiB per step")
    if told:
        lines.append("coupling: " + ", ".join(told))
    audit = [f"{label} {coupling[key]:.2g}" for label, key in
             (("momentum residual", "momentum_residual"), ("interface work residual", "interface_work_residual"),
              ("interface numerical loss", "interface_numerical_loss"))
             if isinstance(coupling.get(key), (int, float))]
    if audit:
        lines.append("audit: " + ", ".join(audit) + " (relative)")
    return lines


def print_report(out, summary, screen=None):
    screen = screen or console()
    if summary.get("checks"):
        wide = screen.width >= ROOM_FOR_NOTES
        screen.print(check_table(summary.get("title", summary.get("case", "")), summary["checks"], wide))
        for line in [] if wide else notes_below(summary["checks"]):
            screen.print(line)
    for line in figures(summary):
        screen.print("  " + line)
    screen.print(f"  results: {shown(out)}")
    for name, text in (("report.png", "picture"), ("sph.xdmf", "open in ParaView"), ("fem.xdmf", "open in ParaView"),
                       ("contact.xdmf", "open in ParaView")):
        if (out / name).exists():
            screen.print(f"  {text}: {shown(out / name)}")

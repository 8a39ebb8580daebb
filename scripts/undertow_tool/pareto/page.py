"""Table and picture of a ladder."""
from rich.table import Table

from ..pictures import INK, OURS, STRUCTURE, new_figure, plt
from ..table import number
from .measure import best_of


def error_text(error):
    return "-" if error is None else f"{100 * error:.2g} %"


def rows_of(ladder, figures):
    """Header and rows of text. Costs are of the whole run; speed is against the reference run."""
    names = list(figures[0]["errors"])
    reference = next((row for row in figures if row["name"] == ladder.reference), figures[0])
    head = ["run", *names, "dt [s]", "steps", "wall [s]", "CPU [s]", "faster", "step limited by"]
    lines = []
    for row in figures:
        cost = row["cost"]
        lines.append([row["name"], *("0" if row is reference and ladder.curves and row["errors"][n] == 0
                                     else error_text(row["errors"][n]) for n in names),
                      number(cost["dt_mean"]), number(cost["steps"]), f"{cost['wall_s']:.1f}",
                      "-" if cost["cpu_s"] is None else f"{cost['cpu_s']:.1f}",
                      f"{reference['cost']['wall_s'] / cost['wall_s']:.2g} x", cost["limiter"]])
    return head, lines


def screen_table(ladder, figures):
    head, lines = rows_of(ladder, figures)
    table = Table(title=ladder.title, title_justify="left", title_style="bold")
    for index, column in enumerate(head):
        table.add_column(column, justify="left" if index in (0, len(head) - 1) else "right", overflow="fold")
    for line in lines:
        table.add_row(*line)
    return table


def page_text(ladder, figures, picture, command, machine):
    head, lines = rows_of(ladder, figures)
    text = [f"# {ladder.title}", "", ladder.about, ""] if ladder.about else [f"# {ladder.title}", ""]
    text += [f"`{command}` makes this page; {machine}.", ""]
    text += ["| " + " | ".join(head) + " |", "|---" * len(head) + "|"]
    text += ["| " + " | ".join(line) + " |" for line in lines]
    notes = [f"- {row['name']}: {row['note']}" for row in figures if row["note"]]
    text += ["", *notes, "", f"![Error against wall time]({picture})", ""]
    return "\n".join(text)


def draw(ladder, figures, path):
    """Each error against wall time, the runs that no other beats in both joined by a line; runs by their number."""
    names = [name for name in figures[0]["errors"] if any(row["errors"][name] for row in figures)]
    twin = next((run.name for run in ladder.runs if run.twin), "")
    figure = new_figure((3.6 * len(names) + 2.8, 4.0))
    panels = figure.subplots(1, len(names), squeeze=False)[0]
    for panel, name in zip(panels, names):
        rated = [(number, row) for number, row in enumerate(figures, 1) if row["errors"][name] is not None]
        best = best_of([row for _, row in rated], name)
        places = sorted((row["cost"]["wall_s"], 100 * abs(row["errors"][name]), number, row["name"])
                        for number, row in rated)
        panel.plot([x for x, _, _, who in places if who in best], [y for _, y, _, who in places if who in best],
                   color=OURS, linewidth=1, zorder=1)
        for x, y, number, who in places:
            panel.plot(x, y, "o", color=OURS if who in best else STRUCTURE, markersize=12, zorder=2)
            panel.annotate(str(number), (x, y), ha="center", va="center", fontsize=8, color="white", zorder=3)
            if who == twin and name in [curve.name for curve in ladder.curves]:
                panel.axhspan(0, y, color=STRUCTURE, alpha=0.15, linewidth=0, zorder=0)
        panel.set(xscale="log", xlabel="wall time [s]", title=name)
        panel.set_ylim(0, 1.15 * max(y for _, y, _, _ in places))
        panel.margins(x=0.12)
    panels[0].set_ylabel("error [%]")
    lines = [f"{number}  {row['name']}" for number, row in enumerate(figures, 1)]
    if twin:
        lines += ["", "gray: what two runs of the", "reference differ by"]
    figure.suptitle(ladder.title, x=0.02, ha="left", fontsize=12, fontweight="bold")
    figure.tight_layout(rect=(0, 0, 1 - 2.8 / figure.get_figwidth(), 1))
    figure.text(1 - 2.7 / figure.get_figwidth(), 0.85, "\n".join(lines), ha="left", va="top", fontsize=9, color=INK,
                linespacing=1.5)
    figure.savefig(path)
    plt.close(figure)

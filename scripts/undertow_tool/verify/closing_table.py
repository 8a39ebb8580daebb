"""The table at the top of docs/validation_sph.md: one or two rows a verification, taken from the tables below it."""
import math
import re

import numpy as np

BEGIN = "<!-- verify, closing table: begin (written by scripts/undertow verify --docs) -->"
END = "<!-- verify, closing table: end -->"
TITLES = ("case", "dx [m]", "quantity", "errors", "order", "allowed", "", "CPU [s]", "M particle-steps/CPU s")
WORST = ("-", "ok", "mended", "defect", "FAILS")


def cells_of(line):
    return [cell.strip().replace("\\|", "|") for cell in re.split(r"(?<!\\)\|", line)[1:-1]]


def rows_of(section):
    """[(level, {column: text})] of a section's table, variants left out."""
    lines = [line for line in section if line.startswith("|")]
    titles, rows, run = cells_of(lines[0]), [], {}
    for line in lines[2:]:
        row = dict(zip(titles, cells_of(line)))
        if row["level"]:
            run = {key: value for key, value in row.items() if value}
        row = {**run, **{key: row[key] for key in ("quantity", "ours", "error", "allowed", "")}}
        if " " not in row["level"]:
            rows.append((row["level"], row))
    return rows


def magnitude(text):
    """Of "+0.4 %" or "0.0025"; None of "-"."""
    found = re.match(r"[-+]?[\d.]+(?:e[-+]?\d+)?", text)
    return abs(float(found.group())) if found and text != "-" else None


def order_of(rows):
    """Slope of log error over log dx; "-" where an error is zero in the digits shown."""
    pairs = [(float(row["dx [m]"].replace(",", "")), magnitude(row["error"])) for row in rows]
    if len(pairs) < 2 or any(not error for _, error in pairs):
        return "-"
    return f"{np.polyfit([math.log(dx) for dx, _ in pairs], [math.log(e) for _, e in pairs], 1)[0]:.1f}"


def together(texts):
    """"+0.4 %", "+0.6 %" -> "+0.4, +0.6 %"."""
    if len(texts) > 1 and all(text.endswith(" %") for text in texts):
        return ", ".join(text[:-2] for text in texts) + " %"
    return ", ".join(texts)


def closing_rows(name, section, report):
    """Rows of one verification: those that [report] headline names, or else converges."""
    rows, lines = rows_of(section), []
    for quantity in report.get("headline", report.get("converges", [])):
        own = [(level, row) for level, row in rows if row["quantity"] == quantity]
        ladder = [row for level, row in own if level in report["ladder"]]
        if not ladder:
            continue
        errors = together([row["error"] for row in ladder])
        for level, row in own:
            if level not in report["ladder"]:
                errors += f"; {level} {row['error']}"
        state = max((row[""] for _, row in own), key=WORST.index)
        if state in ("defect", "FAILS"):
            state += " (" + ", ".join(level for level, row in own if row[""] == state) + ")"
        if lines:       # the run is told once
            run = [""] * 2, [""] * 2
        else:
            run = ([f"[{name}](#{anchor(section)})", ", ".join(row["dx [m]"] for row in ladder)],
                   [", ".join(row["CPU [s]"] for row in ladder), ladder[-1]["M particle-steps/CPU s"]])
        order = order_of(ladder) if quantity in report.get("converges", []) else "-"
        lines.append("| " + " | ".join([*run[0], quantity.replace("|", "\\|"), errors, order, ladder[-1]["allowed"], state,
                                        *run[1]]) + " |")
    return lines


def anchor(section):
    """Of a section's heading, as Markdown viewers make it."""
    title = next(line for line in section if line.startswith("### "))[4:]
    return re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-")


def closing_table(sections, reports):
    """sections, reports: of each verification, by name."""
    lines = ["| " + " | ".join(TITLES) + " |", "|" + "---|" * len(TITLES)]
    for name in sorted(sections):
        lines += closing_rows(name, sections[name], reports[name])
    return lines


def with_closing_table(text, sections, reports):
    """The page's text with the table between its marks."""
    before, rest = text.split(BEGIN)
    return before + "\n".join([BEGIN, "", *closing_table(sections, reports), "", END]) + rest.split(END)[1]

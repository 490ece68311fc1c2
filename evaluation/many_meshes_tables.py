"""The tables of docs/ray.md, from a result file of `many_meshes`."""

from __future__ import annotations

from .markdown import table

#: Of what the bill is made: meshes, and the price of an hour of one CPU.
MANY = 1_000_000
PRICE = 0.04


def report(result: dict) -> str:
    """Rows after two kills, and what Ray adds to the command line's time."""
    head = f"`make evaluate-ray`, {result['date']} ([data](results/{result['date']}-ray.json)); {result['machine']}, Ray {result['ray']}."
    start = f"Starting Ray and its first worker takes {result['start_seconds']:.0f} s, which these tables leave out."
    tables = [rows(result["compared"]), runs(result["killed_twice"]), overheads(result), of_a_run(result)]
    return "\n\n".join([head, *tables, start])


def rows(compared: dict) -> str:
    """What is in the table after the last run."""
    outcomes = compared["outcomes"]
    header = ["meshes", "rows", "lost", "doubled", "unlike the command line's", *outcomes]
    names = ("meshes", "rows", "lost", "doubled", "unlike_the_command_line")
    return table(header, [[f"{value:,}" for value in [*(compared[name] for name in names), *outcomes.values()]]])


def runs(history: list[dict]) -> str:
    """What was killed when, and what was there before and after."""
    lines = [
        [number, killed(run["killed"]), f"{run['rows_before']:,}", f"{run['rows_after']:,}", f"{run['seconds']:.0f}"]
        for number, run in enumerate(history, 1)
    ]
    return table(["run", "killed, and at which share of the rows", "rows before", "rows after", "s"], lines)


def killed(kills: list) -> str:
    """Such as "driver at 25 %"."""
    return ", ".join(f"{victim} at {100 * share:.0f} %" for share, victim in kills) or "nothing"


def overheads(result: dict) -> str:
    """Both ways over the same meshes: medians of runs in turns."""
    lines = []
    small, large = result["costs"]
    for name, cost in (("small", small), ("large_few", large), ("large", large)):
        measured = result[name]
        ours, theirs = measured["medians"]["ray"], measured["medians"]["command_line"]
        seconds = [f"{theirs['wall']:.1f}", f"{ours['wall']:.1f}", f"{theirs['cpu']:.1f}", f"{ours['cpu']:.1f}"]
        shares = [f"{100 * measured['overhead'][kind]:+.1f} %" for kind in ("wall", "cpu")]
        lines.append([f"{cost['vertices']:,}", f"{measured['meshes']:,}", *seconds, *shares])
    header = ["vertices", "meshes", "`--jobs 2`, wall s", "Ray, wall s", "`--jobs 2`, CPU s", "Ray, CPU s"]
    return table([*header, "overhead, wall", "overhead, CPU"], lines)


def of_a_run(result: dict) -> str:
    """What Ray adds to a run, and to each of its large meshes: from two numbers of them."""
    few, many = result["large_few"], result["large"]
    more = many["meshes"] - few["meshes"]

    def a_mesh(way: str, kind: str) -> float:
        return (many["medians"][way][kind] - few["medians"][way][kind]) / more

    shares = [100 * (a_mesh("ray", kind) / a_mesh("command_line", kind) - 1) for kind in ("wall", "cpu")]
    added = few["medians"]["ray"]["wall"] - few["medians"]["command_line"]["wall"]
    fixed = added - few["meshes"] * (a_mesh("ray", "wall") - a_mesh("command_line", "wall"))
    return (
        f"Of the large meshes, from the two numbers of them: Ray adds {fixed:.1f} s to a run, and {shares[0]:+.1f} % of wall time "
        f"and {shares[1]:+.1f} % of CPU time to each mesh."
    )


def bill(result: dict) -> str:
    """CPU hours, money and storage of a million meshes, by size and effort."""
    lines = []
    for cost in result["costs"]:
        for effort, seconds in cost["cpu_seconds"].items():
            hours = MANY * seconds / 3600
            gigabytes = MANY * cost["vertices"] * cost["bytes_for_a_vertex"] / 1e9
            figures = [f"{seconds:.3f}", f"{hours:,.0f}", f"{PRICE * hours:,.0f}", f"{gigabytes:,.1f}"]
            lines.append([f"{cost['vertices']:,}", effort, *figures, f"{cost['process_megabytes']:.0f}"])
    header = ["vertices", "effort", "CPU s a mesh", "CPU hours", f"money at {PRICE} an hour", "GB of Parquet"]
    return table([*header, "MB of a mesh's process"], lines)

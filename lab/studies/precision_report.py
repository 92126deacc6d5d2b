# SPDX-License-Identifier: Apache-2.0
"""The figures of `tactus bench precision` as tables, JSON, Markdown and diagrams."""
from common import figure, table
from studies import report

ERRORS = ["displacement_error", "displacement_end_error", "velocity_error", "force_error", "energy_error", "weight_error",
          "push_error"]
TIME_HEAD = ["method", "h [ms]", "u", "u, end", "v", "force", "energy", "weight", "push", "ms/step", "s/s", "setup [ms]",
             "Newton", "solver"]
SPACE_HEAD = ["edge", "tets", "static [mm/N]", "error", "quadratic [mm/N]", "error", "in time, error", "h [ms]", "s/s"]
DRAWN = {"displacement": "relative error of displacements", "force": "relative error of the force at the probe",
         "energy": "relative error of energy", "weight": "relative error of displacements under a weight that is there at once"}


def scientific(value):
    return "-" if value is None else f"{value:.1e}"


def milliseconds(seconds):
    return f"{1e3 * seconds:.3g}"


def percent(value):
    return "-" if value is None else f"{100 * value:.2g} %"


def plain(value, digits=3):
    return "-" if value is None else f"{value:.{digits}g}"


def per_step(point):
    return point["seconds_per_second"] * point["step_s"]


def method_of(point):
    return f"{point['method']}: {point['taken']}" if point["taken"] else point["method"]


def is_usable(error):
    """Finished, with an error below the size of the solution."""
    return error is not None and 0 < error < 1


def time_cells(point):
    cells = [method_of(point), milliseconds(point["step_s"])]
    if point["displacement_error"] is None:
        return cells + ["stopped"] + [""] * (len(TIME_HEAD) - 3)
    return cells + [scientific(point[error]) for error in ERRORS] + [
        milliseconds(per_step(point)), plain(point["seconds_per_second"]), milliseconds(point["setup_s"]),
        plain(point["newton_per_step"]),
        plain(point["solver_per_step"])]


def space_cells(space, i):
    point = space["points"][i]
    in_time, quadratic = point["step_s"] > 0, point["quadratic_m_per_n"] > 0
    return [f"1/{point['refinement']}", str(point["tets"]), f"{1e3 * point['deflection_m_per_n']:.4g}",
            percent(space["static_error"][i]),
            f"{1e3 * point['quadratic_m_per_n']:.4g}" if quadratic else "-", percent(space["quadratic_error"][i]),
            percent(space["transient_error"][i]), milliseconds(point["step_s"]) if in_time else "-",
            plain(point["seconds_per_second"]) if in_time else "-"]


def limit_text(space):
    return (f"limit of quadratic elements {1e3 * space['limit']:.4g} +- {1e3 * space['uncertainty']:.2g} mm/N, "
            f"their observed order {space['order']:.2f}")


def space_title(space):
    return f"{space['scene']}, nu {space['points'][0]['poisson']:.3g}"


def reference_text(time):
    reference = time["reference"]
    own = ", ".join(f"{name} {scientific(reference[error])}" for name, error in [
        ("u", "displacement_error"), ("v", "velocity_error"), ("force", "force_error"), ("energy", "energy_error"),
        ("weight", "weight_error"), ("push", "push_error")])
    return ("reference: Runge-Kutta of order 4, not among the methods compared, "
            f"h = {1e6 * reference['step_s']:.3g} us, {reference['remark']}; its own error: {own}")


def omissions(time):
    """What is not in the tables, or only in part, and why."""
    out, points = [], time["points"]
    for i, point in enumerate(points):
        label = f"{point['method']}, h = {milliseconds(point['step_s'])} ms: "
        if point["remark"]:
            out.append(label + point["remark"])
        elif not is_usable(point["displacement_error"]):
            out.append(label + "finished, but no better than standing still")
        is_last = i + 1 == len(points) or points[i + 1]["method"] != point["method"]
        if is_last and point["steps_per_sample"] != time["plan"]["steps_per_sample"][-1]:
            out.append(f"{point['method']}, h below {milliseconds(point['step_s'])} ms: left out, "
                       f"{point['seconds_per_second']:.2g} times slower than real time there already")
    return out


def rigid_cells(motion, point):
    return [motion["title"], str(point["parts"]), str(point["iterations"]), scientific(point["error"]), motion["unit"],
            f"{1e6 * point['seconds_per_tick']:.3g}"]


RIGID_HEAD = ["motion", "parts of a tick", "iterations", "error", "unit", "us/tick"]


def rigid_figure(motion):
    """Processor time over error: a line for each number of iterations, marks at 1, 2, 4 and 8 parts of a tick."""
    fig, axes = figure.pyplot().subplots(figsize=(figure.WIDTH, 3.6))
    for number, iterations in enumerate(sorted({point["iterations"] for point in motion["points"]})):
        points = [p for p in motion["points"] if p["iterations"] == iterations and p["error"]]
        if points:
            figure.line(axes, [p["error"] for p in points], [1e6 * p["seconds_per_tick"] for p in points], number,
                        label=f"{iterations} iterations")
        for p in points:
            axes.annotate(str(p["parts"]), (p["error"], 1e6 * p["seconds_per_tick"]), xytext=(3, 3),
                          textcoords="offset points", fontsize=6)
    figure.logarithmic(axes)
    axes.set_title(motion["title"] + "; numbers: parts of a tick", loc="left")
    axes.set_xlabel(f"error [{motion['unit']}]")
    axes.set_ylabel("processor time per tick [us]")
    axes.legend()
    return fig


def show(made):
    if made["rigid"]:
        table.show(RIGID_HEAD, [rigid_cells(motion, point) for motion in made["rigid"] for point in motion["points"]])
        print()
    for time in made["times"]:
        print(f"{time['plan']['title']}\n{reference_text(time)}\n")
        rows, before = [], None
        for point in time["points"]:
            cells = time_cells(point)
            rows.append(["" if before == point["method"] and not point["taken"] else cells[0], *cells[1:]])
            before = point["method"]
        table.show(TIME_HEAD, rows)
        print("\n".join(omissions(time)) + "\n" if omissions(time) else "")
    for space in made["spaces"]:
        print(f"space error, {space_title(space)}: {limit_text(space)}\n")
        table.show(SPACE_HEAD, [space_cells(space, i) for i in range(len(space["points"]))])
        print()


def as_json(made):
    def of_point(point):
        out = {"method": point["method"], "step_s": point["step_s"]} | {error: point[error] for error in ERRORS} | {
            "seconds_per_second": point["seconds_per_second"], "seconds_per_step": per_step(point), "setup_s": point["setup_s"],
            "runs": point["runs"], "newton_per_step": point["newton_per_step"],
            "solver_iterations_per_step": point["solver_per_step"],
            "unconverged_steps": point["unconverged_steps"]}
        return out | {key: point[key] for key in ("taken", "remark") if point[key]}

    def of_time(time):
        plan = time["plan"]
        return {key: plan[key] for key in ("scene", "seconds", "vertices", "tets")} | {
            "reference": of_point(time["reference"]), "points": [of_point(point) for point in time["points"]]}

    def of_space(space):
        points = [{key: point[key] for key in ("refinement", "vertices", "tets", "deflection_m_per_n")} | {
            "static_error": space["static_error"][i], "quadratic_error": space["quadratic_error"][i],
            "transient_error": space["transient_error"][i], "step_s": point["step_s"],
            "seconds_per_second": point["seconds_per_second"]}
            for i, point in enumerate(space["points"])]
        return {"scene": space["scene"], "poisson": space["points"][0]["poisson"], "limit_m_per_n": space["limit"],
                "limit_uncertainty_m_per_n": space["uncertainty"], "observed_order": space["order"], "points": points}

    out = {"schema": "tactus.precision/1", "context": made["context"]}
    if made["times"]:
        out["time"] = [of_time(time) for time in made["times"]]
    if made["rigid"]:
        out["rigid"] = made["rigid"]
    return out | ({"space": [of_space(space) for space in made["spaces"]]} if made["spaces"] else {})


def at_one_millisecond(made):
    """The row of each method at 1 ms in every scene: error of u under the smooth load, under weight, processor time."""
    head, rows = ["method"], []
    for time in made["times"]:
        head += [f"{time['plan']['scene']}: {column}" for column in ("u", "weight", "ms/step")]
    for method in made["times"][0]["plan"]["methods"]:
        row = [method["name"]]
        for time in made["times"]:
            at = next((p for p in time["points"] if p["method"] == method["name"] and abs(p["step_s"] - 1e-3) < 1e-9), None)
            finished = at is not None and at["displacement_error"] is not None
            row += [scientific(at["displacement_error"]), scientific(at["weight_error"]),
                    milliseconds(per_step(at))] if finished else [
                "stopped", "", ""]
        rows.append(row)
    return report.markdown(head, rows)


def markdown(made):
    out = ("# Error against run time\n\n"
           "Made by `tactus bench precision`. The columns are relative errors over all sample times: of displacement (`u`; `u, "
           "end` only at "
           "the\nlast one), velocity (`v`) and energy under a load that grows from zero, of the force of a probe, and of the "
           "displacements "
           "under self weight\n(`weight`) and load (`push`) applied at once; then processor time per step, seconds of one core "
           "per simulated "
           "second (`s/s`; below 1:\nfaster than real time), time up to the second step (`setup`), Newton and solver iterations "
           "per step. "
           "Times are medians. `chosen` is the\nmethod that `tactus sim` takes.\n\n")
    out += "".join(f"* {key}: {value}\n" for key, value in made["context"].items())
    if made["times"]:
        out += "\n## At 1 kHz\n\n" + at_one_millisecond(made)
    for time in made["times"]:
        plan = time["plan"]
        out += (f"\n## {plan['scene']}\n\n{plan['title']}, {plan['vertices']} vertices, {plan['tets']} tetrahedra, "
                f"{plan['seconds']:g} s.\n"
                f"{reference_text(time)}.\n\n")
        out += "".join(f"![{plan['scene']}: run time against error of {name}]({plan['scene']}-{name}.svg)\n" for name in DRAWN)
        out += "\n" + report.markdown(TIME_HEAD, [time_cells(point) for point in time["points"]])
        if omissions(time):
            out += "\n### Omissions\n\n" + "".join(f"* {text}\n" for text in omissions(time))
    if made["rigid"]:
        out += ("\n## Rigid objects\n\nODE in parts of a tick of 1 ms, by iterations of the contact solver; where they leave more than "
                "2 mm/s it solves again. References are formulas, or\nthe same with 64 parts and 400 iterations.\n\n")
        out += "".join(f"![{motion['title']}](rigid-{motion['name']}.svg)\n" for motion in made["rigid"])
        out += "\n" + report.markdown(RIGID_HEAD, [rigid_cells(motion, point) for motion in made["rigid"] for point in motion["points"]])
    if not made["spaces"]:
        return out
    out += ("\n## Space error\n\n"
            "Error of the loaded patch's mean deflection against its limit under refinement. No time step reduces it.\n\n")
    for scene in dict.fromkeys(space["scene"] for space in made["spaces"]):
        out += f"![{scene}: space error](space-{scene}.svg)\n"
    for space in made["spaces"]:
        out += f"\n### {space_title(space)}\n\n{limit_text(space)}.\n\n" + report.markdown(
            SPACE_HEAD, [space_cells(space, i) for i in range(len(space["points"]))])
    return out


def figures(made):
    """(name, function that draws) of every diagram."""
    for time in made["times"]:
        for quantity in DRAWN:
            yield f"{time['plan']['scene']}-{quantity}", lambda time=time, quantity=quantity: time_figure(time, quantity)
    for motion in made["rigid"]:
        yield "rigid-" + motion["name"], lambda motion=motion: rigid_figure(motion)
    for scene in dict.fromkeys(space["scene"] for space in made["spaces"]):
        yield "space-" + scene, lambda scene=scene: space_figure([space for space in made["spaces"] if space["scene"] == scene])


def family(method):
    """"Newmark" of "Newmark 1x PCG": one colour each."""
    return next(name for name in FAMILIES if method.startswith(name))


FAMILIES = ["chosen", "velocity Verlet", "backward Euler", "Newmark", "TR-BDF2", "projective", "modal"]


def time_figure(time, quantity):
    """Processor time over error: a line for each method, marks at its step sizes."""
    fig, axes = figure.pyplot().subplots(figsize=(figure.WIDTH * 1.45, 5.2))
    variants = {}
    for method in time["plan"]["methods"]:
        name = method["name"]
        variant = variants[family(name)] = variants.get(family(name), -1) + 1
        points = [p for p in time["points"] if p["method"] == name and is_usable(p[quantity + "_error"])]
        if not points:
            continue
        x, y = [p[quantity + "_error"] for p in points], [p["seconds_per_second"] for p in points]
        colour = figure.COLOURS[(FAMILIES.index(family(name)) - 1) % len(figure.COLOURS)]
        axes.plot(x, y, color=colour, linestyle=figure.DASHES[variant], marker=figure.MARKERS[FAMILIES.index(family(name))],
                  markerfacecolor=colour if variant == 0 else "white", linewidth=2 if name == "chosen" else 1.2, label=name)
        if not method["is_linear"]:  # linear elasticity is off by the same at every step
            for p, a, b in zip(points, x, y):
                axes.annotate(milliseconds(p["step_s"]), (a, b), xytext=(3, 3), textcoords="offset points", fontsize=6,
                              color=colour)
    ringed = [p for p in time["points"] if is_usable(p[quantity + "_error"]) and abs(p["step_s"] - 1e-3) < 1e-9]
    axes.plot([p[quantity + "_error"] for p in ringed], [p["seconds_per_second"] for p in ringed], linestyle="none", marker="o",
              markersize=9, markerfacecolor="none", color="#222222", label="h = 1 ms")
    axes.axhline(1, color="#222222", linewidth=1, label="real time; at 1 kHz, 1 ms per step")
    figure.logarithmic(axes)
    axes.set_title(time["plan"]["title"] + "; numbers: h in ms", loc="left")
    axes.set_xlabel(f"{DRAWN[quantity]} (the reference is off by {scientific(time['reference'][quantity + '_error'])})")
    axes.set_ylabel("seconds of one core per simulated second")
    axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1), borderaxespad=0)
    return fig


def space_figure(spaces):
    """Error of the deflection over the size of the mesh."""
    fig, (axes,) = figure.panels(width=figure.WIDTH * 1.3)
    for number, space in enumerate(spaces):
        tets, nu = [point["tets"] for point in space["points"]], f"ν {space['points'][0]['poisson']:.3g}"
        style = figure.style_of(number)
        axes.plot(tets, space["static_error"], label=f"linear, {nu}", **style)
        quadratic = [(x, y) for x, y in zip(tets, space["quadratic_error"]) if y]
        axes.plot([x for x, _ in quadratic], [y for _, y in quadratic], color=style["color"], marker=style["marker"],
                  linestyle="none",
                  markerfacecolor="white", label=f"quadratic, {nu}")
        transient = [(x, y) for x, y in zip(tets, space["transient_error"]) if y]
        if transient:
            axes.plot([x for x, _ in transient], [y for _, y in transient], color=style["color"], linestyle="--", marker="v",
                      label=f"linear in time, {nu}, against the finest")
    figure.logarithmic(axes)
    axes.set_title(f"{spaces[0]['scene']}: deflection of the loaded patch", loc="left")
    axes.set_xlabel("tetrahedra")
    axes.set_ylabel("relative error of the deflection")
    axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1), borderaxespad=0)
    return fig

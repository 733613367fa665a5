// Plots of outcomes: evaluated against predicted values, and deviations over the runs.

import { el, fill, fixed, moment } from "/dashboard/app.js";
import { colour, layout, plot } from "/dashboard/charts.js";

/** Columns of an outcome, with the factor from their unit to the user's. */
const QUANTITIES = {
  force: ["cutting force", "N", "force_predicted_n", "force_measured_n", 1],
  feed: ["feed", "mm/min", "feed_predicted_mm_s", "feed_measured_mm_s", 60],
  time: ["time", "s", "time_predicted_s", "time_measured_s", 1],
  roughness: ["roughness Ra", "µm", "roughness_predicted_mm", "roughness_measured_mm", 1000],
};
const SYMBOLS = [["circle", "●"], ["square", "■"], ["triangle-up", "▲"], ["diamond", "◆"], ["cross", "✚"], ["x", "✖"]];
const COLOURS = 7;
let wanted = "force";

const curve = (at) => `curve-${(at % COLOURS) + 1}`;
const symbol = (at) => SYMBOLS[at % SYMBOLS.length];

/** Draw both plots of a listing of outcomes, newest first. */
export async function outcomePlots(place, found) {
  const outcomes = [...found.outcomes].reverse();
  if (!outcomes.length) { fill(place); return; }
  const tools = [...new Set(outcomes.map((each) => each.tool))].sort();
  const runs = [...new Set(outcomes.map((each) => each.run))];
  const choice = el("select", { id: "quantity", onchange: () => { wanted = choice.value; draw(); } },
    Object.entries(QUANTITIES).map(([name, [title]]) => el("option", { value: name, selected: name === wanted }, title)));
  const scatter = el("div", { class: "chart", id: "scatter", role: "figure" });
  const over = el("div", { class: "chart", id: "over-runs", role: "figure" });
  const summed = el("p", { class: "soft small", id: "plots-words" });
  fill(place, el("section", { class: "card", "aria-labelledby": "plots-title" },
    el("div", { class: "row spread" }, el("h2", { id: "plots-title" }, "Predicted and measured values"),
      el("label", { class: "inline" }, "Quantity", choice)),
    el("ul", { class: "keys", "aria-label": "tools" }, tools.map((tool, at) => el("li", {},
      el("span", { "aria-hidden": "true", style: `color: var(--${curve(at)})` }, `${symbol(at)[1]} `), tool))),
    el("div", { class: "columns" },
      el("div", { style: "grid-column: span 6" }, el("h3", {}, "Evaluated against predicted"), scatter),
      el("div", { style: "grid-column: span 6" }, el("h3", {}, "Deviation over the runs"), over)), summed));

  async function draw() {
    const [title, unit, planned, was, scale] = QUANTITIES[wanted];
    const points = outcomes.filter((each) => each[planned] > 0 && each[was] !== null).map((each) => ({
      ...each, x: each[planned] * scale, y: each[was] * scale, off: 100 * (each[was] / each[planned] - 1),
      run: runs.indexOf(each.run) + 1,
      words: `${each.workingstep}<br>${each.program}<br>${each.tool}<br>run ${runs.indexOf(each.run) + 1}, ${moment(each.recorded_at)}`,
    }));
    const near = points.filter(({ off }) => Math.abs(off) <= 10).length;
    summed.textContent = points.length
      ? `${points.length} of ${outcomes.length} outcomes have both values of the ${title}; ${near} lie within 10 % of the plan (the band). The line over the runs is the mean of each.`
      : `No outcome has both values of the ${title}.`;
    scatter.setAttribute("aria-label", `evaluated against predicted ${title}. ${summed.textContent}`);
    over.setAttribute("aria-label", `deviation of the ${title} over ${runs.length} runs. ${summed.textContent}`);
    const values = points.flatMap(({ x, y }) => [x, y]).filter((value) => value > 0);
    const [least, most] = values.length ? [Math.min(...values), Math.max(...values)] : [1, 10];
    const isLog = most / least > 20;
    const traces = (make) => tools.map((tool, at) => ({ at, own: points.filter((each) => each.tool === tool) }))
      .filter(({ own }) => own.length).map(({ at, own }) => ({ type: "scatter", mode: "markers", name: tools[at],
        marker: { color: colour(curve(at)), symbol: symbol(at)[0], size: 8, opacity: 0.8 }, text: own.map(({ words }) => words), ...make(own) }));
    const axis = { type: isLog ? "log" : "linear", dtick: isLog ? 1 : undefined,
      range: isLog ? [Math.log10(least / 1.4), Math.log10(most * 1.4)] : [0, most * 1.08] };
    const ends = isLog ? [least / 1.4, most * 1.4] : [0, most * 1.08];
    const line = (factor, more) => ({ type: "scatter", mode: "lines", x: ends, y: ends.map((end) => end * factor), hoverinfo: "skip", ...more });

    await plot(scatter, () => ({
      data: [line(0.9, { line: { width: 0 } }),
        line(1.1, { line: { width: 0 }, fill: "tonexty", fillcolor: faint() }),
        line(1, { line: { color: colour("soft"), width: 1.2, dash: "dash" } }),
        ...traces((own) => ({ x: own.map(({ x }) => x), y: own.map(({ y }) => y),
          customdata: own.map(({ off }) => signed(off)),
          hovertemplate: `%{text}<br>predicted %{x:.4~r} ${unit}, evaluated %{y:.4~r} ${unit}: %{customdata}<extra></extra>` }))],
      layout: layout({ height: 340, hovermode: "closest",
        xaxis: { ...axis, title: { text: `predicted ${title}, ${unit}`, standoff: 6 } },
        yaxis: { ...axis, title: { text: `evaluated, ${unit}`, standoff: 4 } } }),
    }));
    const means = runs.map((_, at) => {
      const own = points.filter(({ run }) => run === at + 1);
      return own.length ? own.reduce((sum, { off }) => sum + off, 0) / own.length : null;
    });
    await plot(over, () => ({
      data: [...traces((own) => ({ x: own.map(({ run }) => run), y: own.map(({ off }) => off),
        hovertemplate: `%{text}<br>%{y:+.1f} %<extra></extra>` })),
      { type: "scatter", mode: "lines", x: runs.map((_, at) => at + 1), y: means, connectgaps: true,
        line: { color: colour("ink"), width: 1.4 }, hovertemplate: "mean of the run %{y:+.1f} %<extra></extra>" }],
      layout: layout({ height: 340, hovermode: "closest",
        shapes: [{ type: "rect", xref: "paper", x0: 0, x1: 1, y0: -10, y1: 10, fillcolor: faint(), line: { width: 0 }, layer: "below" }],
        xaxis: { title: { text: "run, oldest first", standoff: 6 }, tickformat: "d",
          dtick: runs.length <= 20 ? 1 : undefined, range: [0.4, runs.length + 0.6] },
        yaxis: { title: { text: "measured minus planned, %", standoff: 4 }, zeroline: true, zerolinewidth: 2 } }),
    }));
  }
  await draw();
}

const signed = (off) => `${off >= 0 ? "+" : "−"}${fixed(Math.abs(off), 1)} %`;
/** Colour of the ±10 % band behind the points. */
const faint = () => `${colour("curve-7")}2b`;

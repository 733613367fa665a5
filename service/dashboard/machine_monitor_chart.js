// Curves of a real machine, and those of its prediction on the same time axis.

import { api, el } from "/dashboard/app.js";
import { colour, layout, plot } from "/dashboard/charts.js";

const HEIGHT = 150, POINTS = 2000, MOST = 12_000;

/** part of the shown time that lies ahead of the machine, where a prediction is drawn */
const AHEAD = 0.15;

/** width of a letter of the workingsteps' names, in pixels */
const LETTER = 7;

/** Time shown, in s; 0: all that is kept. */
export const WINDOWS = [["60", "1 min"], ["300", "5 min"], ["1200", "20 min"], ["0", "all"]];

const PANELS = [
  { title: "Position, mm", unit: "mm", signals: [
    { name: "x_mm", label: "X", colour: "curve-2" }, { name: "y_mm", label: "Y", colour: "curve-3" },
    { name: "z_mm", label: "Z", colour: "curve-4" }] },
  { title: "Feed, mm/min (rapids leave the frame)", unit: "mm/min",
    signals: [{ name: "feed_actual_mm_min", label: "feed", colour: "curve-1" }] },
  { title: "Spindle power, W", unit: "W", signals: [{ name: "spindle_power_w", label: "spindle power", colour: "curve-1" }] },
  { title: "Total power, W", unit: "W", signals: [{ name: "total_power_w", label: "total power", colour: "curve-1" }] },
];
const SIGNALS = PANELS.flatMap((panel) => panel.signals.map(({ name }) => name));
/** colour of the prediction of a panel with one signal */
const PREDICTED = "curve-2";
/** gives the frame of the feed, which rapids leave */
const COMMANDED = "feed_programmed_mm_min";
const QUERY = [...SIGNALS, COMMANDED].join(",");

/** Create the legend. */
export function monitorKeys() {
  const key = (label, name, dash) => el("li", {}, el("span", { class: `swatch line ${dash ? "dashed" : ""}`,
    "aria-hidden": "true", style: `border-color: var(--${name})` }), label);
  return el("ul", { class: "keys", "aria-label": "legend" }, key("measured", "curve-1", false),
    key("predicted", PREDICTED, true), PANELS[0].signals.map(({ label, colour: name }) => key(label, name, false)));
}

/** Draw the chart of a monitor at a path, and the latest `seconds` of its rows. */
export async function monitorChart(place, path, seconds) {
  let measured = empty(), predicted = null, parts = [], steps = [], id = "", range = null, Plotly = null;
  let timer = null;

  function empty() {
    return { time_s: [], ...Object.fromEntries([...SIGNALS, COMMANDED].map((name) => [name, []])) };
  }

  /** Range of time that is shown, in s. */
  function shown() {
    const first = measured.time_s[0] ?? 0, last = measured.time_s.at(-1) ?? 0;
    if (range) return range;
    const length = seconds || Math.max(last - first, 10);
    const over = parts.length ? parts.at(-1).end_s + parts.at(-1).shift_s : last;
    const end = Math.max(last, Math.min(last + AHEAD * length, over));
    return [seconds ? Math.max(first, end - length) : first, Math.max(end, first + Math.min(length, 10))];
  }

  /** Points of a predicted signal on the measured axis; parts are not joined. */
  function moved(name) {
    const x = [], y = [];
    if (!predicted) return { x, y };
    const { begin_s: begins, signals: { [name]: signal } } = predicted;
    for (const part of parts) {
      begins.forEach((time, at) => {
        if (time < part.begin_s || time > part.end_s) return;
        x.push(time + part.shift_s);
        y.push(signal.mean[at]);
      });
      x.push(part.end_s + part.shift_s);
      y.push(null);
    }
    return { x, y };
  }

  /** Names of the workingsteps that begin in a range, without those that would overlap. */
  function labels(from, to) {
    const second = Math.max(place.clientWidth - 74, 100) / (to - from);
    let free = -Infinity;
    return steps.filter(({ id: text, begin_s: begin }) => {
      const isShown = text && begin >= from && begin <= to && begin * second >= free;
      if (isShown) free = begin * second + LETTER * text.length + 8;
      return isShown;
    }).map((step) => ({ text: step.id, x: step.begin_s, xref: "x", xanchor: "left", y: 1, yref: "paper",
      yanchor: "bottom", yshift: 14, showarrow: false, font: { size: 11, color: colour("soft") } }));
  }

  function make() {
    const data = [], count = PANELS.length;
    const laid = layout({ height: HEIGHT * count + 40, margin: { l: 62, r: 12, t: 34, b: 36 },
      grid: { rows: count, columns: 1, pattern: "independent" } });
    const [from, to] = shown();
    laid.shapes = [];
    laid.annotations = labels(from, to);
    for (const step of steps) {
      laid.shapes.push({ type: "line", x0: step.begin_s, x1: step.begin_s, y0: 0, y1: 1, xref: "x",
        yref: "paper", line: { width: 1, dash: "dot", color: colour("soft") } });
    }
    const share = 1 / count, space = 26 / (HEIGHT * count);
    PANELS.forEach((panel, row) => {
      const at = row === 0 ? "" : String(row + 1), top = 1 - row * share;
      laid[`yaxis${at}`] = { ...laid.yaxis, domain: [Math.max(top - share + space, 0), top - 0.002],
        rangemode: row ? "tozero" : "normal", nticks: 4, anchor: `x${at}` };
      laid[`xaxis${at}`] = { ...laid.xaxis, anchor: `y${at}`, matches: row ? "x" : undefined, range: [from, to],
        showticklabels: row === count - 1,
        title: row === count - 1 ? { text: "time of the machine, s", standoff: 4 } : undefined };
      laid.annotations.push({ text: panel.title, x: 0, xref: "paper", xanchor: "left", y: top, yref: "paper",
        yanchor: "bottom", showarrow: false, font: { size: 12 } });
      for (const signal of panel.signals) {
        const axes = { xaxis: `x${at}`, yaxis: `y${at}`, type: "scatter", mode: "lines",
          hovertemplate: `%{y:.4~r} ${panel.unit}` };
        const line = { color: colour(signal.colour), width: 1.5 };
        const dashed = { width: 1.5, dash: "dash", color: colour(row ? PREDICTED : signal.colour) };
        data.push({ ...axes, name: `${signal.label} measured`, x: measured.time_s, y: measured[signal.name], line });
        const prediction = moved(signal.name);
        if (prediction.x.length) {
          data.push({ ...axes, name: `${signal.label} predicted`, ...prediction, line: dashed });
        }
      }
    });
    const most = greatest(from, to);
    if (most) laid.yaxis2.range = [0, 1.35 * most];
    return { data, layout: laid };
  }

  /** Greatest commanded feed that is shown. */
  function greatest(from, to) {
    let most = 0;
    measured.time_s.forEach((time, at) => {
      if (time >= from && time <= to) most = Math.max(most, measured[COMMANDED][at] ?? 0);
    });
    return most;
  }

  async function draw() {
    const isFirst = Plotly === null;
    Plotly = await plot(place, make);
    if (isFirst) {
      place.on("plotly_relayout", (changed) => {
        const begin = changed["xaxis.range[0]"], end = changed["xaxis.range[1]"];
        if (begin !== undefined) range = [begin, end];
        else if (changed["xaxis.autorange"]) range = null;
        else return;
        clearTimeout(timer);
        timer = setTimeout(() => reload(), 120);
      });
    }
  }

  /** Read the kept rows of the shown time. */
  async function reload() {
    const query = new URLSearchParams({ signals: QUERY, points: String(POINTS) });
    if (range) {
      query.set("begin_s", String(range[0]));
    } else if (seconds) {
      const { latest } = await api(path);
      if (latest.time_s) query.set("begin_s", String(Math.max(latest.time_s - seconds, 0)));
    }
    const found = await api(`${path}/rows?${query}`);
    measured = { time_s: found.end_s, ...Object.fromEntries(Object.entries(found.signals).map(
      ([name, { mean }]) => [name, mean])) };
    await readPrediction();
    await draw();
  }

  /** Read the prediction of the shown time, unless it is known. */
  async function readPrediction() {
    if (!id || !parts.length) { predicted = null; return; }
    const [from, to] = shown(), wanted = [Infinity, -Infinity];
    for (const part of parts) {
      const begin = Math.max(part.begin_s, from - part.shift_s), end = Math.min(part.end_s, to - part.shift_s);
      if (begin > end) continue;
      wanted[0] = Math.min(wanted[0], begin);
      wanted[1] = Math.max(wanted[1], end);
    }
    if (wanted[0] > wanted[1]) return;
    const length = Math.max(wanted[1] - wanted[0], 10);
    const isKnown = predicted && predicted.id === id && predicted.from <= wanted[0] && predicted.to >= wanted[1]
      && predicted.to - predicted.from <= 6 * length;
    if (isKnown) return;
    const begin = Math.max(wanted[0] - 0.2 * length, 0), end = wanted[1] + length, asked = id;
    const found = await api(`/v1/simulations/${asked}/series?${new URLSearchParams({ signals: SIGNALS.join(","),
      points: "4000", begin_s: String(begin), end_s: String(end) })}`);
    if (asked === id) predicted = { ...found, id, from: begin, to: end };
  }

  await reload();
  return {
    reload,
    /** Add new rows. */
    add(columns) {
      const last = measured.time_s.at(-1) ?? -Infinity;
      columns.time_s.forEach((time, at) => {
        if (time <= last) return;
        for (const name of Object.keys(measured)) measured[name].push(columns[name][at]);
      });
      if (measured.time_s.length > MOST) for (const each of Object.values(measured)) each.splice(0, MOST / 2);
      draw();
    },
    /** Show another length of time, in s. */
    follow(length) { seconds = length; range = null; return reload(); },
    /** Mark the beginnings of workingsteps. */
    mark(run) { steps = run?.workingsteps ?? []; },
    /** Draw another simulation, or none. */
    predict(simulation) { id = simulation; predicted = null; parts = []; draw(); },
    /** Draw the prediction where it belongs on the measured axis. */
    async align(found) { parts = found; await readPrediction(); await draw(); },
    purge() { clearTimeout(timer); Plotly?.purge(place); },
  };
}

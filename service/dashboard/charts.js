// Plots with plotly.js of the installed package, in the colours of the page; series by range.

import { api } from "/dashboard/app.js";

let loading = null;
/** Load plotly.js when the first plot is needed. */
export function plotly() {
  loading ??= new Promise((resolve, reject) => {
    const script = document.createElement("script");
    script.src = "/dashboard/plotly.min.js";
    script.onload = () => resolve(window.Plotly);
    script.onerror = () => reject(new Error("plotly.js could not be loaded"));
    document.head.append(script);
  });
  return loading;
}

/** Return a colour of the page, by its name in app.css. */
export const colour = (name) =>
  getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();

const CONFIG = { displaylogo: false, responsive: true, showSendToCloud: false,
  modeBarButtonsToRemove: ["select2d", "lasso2d", "sendDataToCloud", "autoScale2d"] };

/** Return a plot layout in the colours of the page. */
export function layout(more = {}) {
  const ink = colour("ink"), rule = colour("rule");
  const axis = { gridcolor: rule, zerolinecolor: rule, linecolor: rule, automargin: true };
  const { xaxis = {}, yaxis = {}, ...rest } = more;
  return {
    paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "rgba(0,0,0,0)",
    font: { family: "system-ui, sans-serif", size: 12, color: ink },
    margin: { l: 56, r: 12, t: 10, b: 36 }, showlegend: false, hovermode: "x unified",
    hoverlabel: { bgcolor: colour("card"), font: { color: ink } },
    modebar: { bgcolor: "rgba(0,0,0,0)", color: colour("soft"), activecolor: colour("accent") },
    dragmode: matchMedia("(pointer: coarse)").matches ? false : "zoom",
    ...rest, xaxis: { ...axis, ...xaxis }, yaxis: { ...axis, ...yaxis },
  };
}

/**
 * Draw a plot, and redraw it when the colours of the page change.
 * `make()` returns {data, layout}, colours by `colour(…)`.
 */
export async function plot(place, make) {
  const Plotly = await plotly();
  const draw = () => {
    const { data, layout: laid } = make();
    // When the window is resized, plotly uses the height of the element.
    if (laid.height) place.style.height = `${laid.height}px`;
    return Plotly.react(place, data, laid, CONFIG);
  };
  place.onTheme ??= (document.addEventListener("theme", () => place.redraw?.()), true);
  place.redraw = draw;
  await draw();
  return Plotly;
}

/** Return one line through minimum and maximum of each point, so that peaks are kept. */
export function envelope(series, name, scale = 1) {
  const { low, high } = series.signals[name], x = [], y = [];
  for (let at = 0; at < low.length; at += 1) {
    x.push(series.begin_s[at]);
    y.push(low[at] === null ? null : low[at] * scale);
    if (series.is_reduced) {
      x.push(series.end_s[at]);
      y.push(high[at] === null ? null : high[at] * scale);
    }
  }
  return { x, y };
}

/** Return the mean of each point; means of parts add up to the mean of the whole. */
function means(series, name, scale = 1) {
  return { x: series.begin_s,
    y: series.signals[name].mean.map((value) => (value === null ? null : value * scale)) };
}

/**
 * Draw panels of signals over a common time axis, read from the server by range: zooming reads again.
 * `source(begin, end, points)` → the path of a series; `panels` = [{title, unit, isStacked,
 * top(greatest) → where its axis ends by the greatest of signals, signals: [{name, label, colour, dash, scale}]}]; `shapes()`
 * are plotly's, drawn over it. Returns {reload, redraw, add(columns), Plotly}.
 */
export async function timePanels(place, source, panels,
  { points = 1500, height = 150, shapes = () => [] } = {}) {
  const Plotly = await plotly();
  const names = panels.flatMap((panel) => panel.signals);
  let series = null, range = null, drawn = 0;
  const live = new Map(names.map((signal) => [signal.name, { x: [], y: [] }]));

  const greatest = (name) => [series?.signals[name].high ?? [], live.get(name).y].flat()
    .reduce((most, value) => Math.max(most, value ?? 0), 0);

  const make = () => {
    drawn += 1;  // the range of time is ours to keep: plotly would keep the last window of a live run
    const data = [], laid = layout({ height: height * panels.length + 40, hovermode: "x unified",
      margin: { l: 62, r: 12, t: 22, b: 36 }, uirevision: "keep",
      grid: { rows: panels.length, columns: 1, pattern: "independent" } });
    laid.annotations = [];
    laid.shapes = shapes();
    const share = 1 / panels.length, space = 26 / (height * panels.length);
    panels.forEach((panel, row) => {
      const number = row === 0 ? "" : String(row + 1), top = 1 - row * share;
      laid[`yaxis${number}`] = { ...laid.yaxis, domain: [Math.max(top - share + space, 0), top - 0.002],
        rangemode: "tozero", title: undefined, nticks: 4, anchor: `x${number}` };
      const end = panel.top?.(greatest);
      if (end) laid[`yaxis${number}`].range = [0, end];
      laid[`xaxis${number}`] = { ...laid.xaxis, anchor: `y${number}`, matches: row ? "x" : undefined,
        showticklabels: row === panels.length - 1, range: range ?? undefined, uirevision: drawn,
        title: row === panels.length - 1 ? { text: "time, s", standoff: 4 } : undefined };
      laid.annotations.push({ text: panel.title, x: 0, xref: "paper", xanchor: "left", y: top,
        yref: "paper", yanchor: "bottom", showarrow: false, font: { size: 12 } });
      for (const signal of panel.signals) {
        const points = panel.isStacked ? means : envelope;
        const { x, y } = series ? points(series, signal.name, signal.scale) : { x: [], y: [] };
        const more = live.get(signal.name);
        data.push({ type: "scatter", mode: "lines", name: signal.label, x: x.concat(more.x),
          y: y.concat(more.y), xaxis: `x${number}`, yaxis: `y${number}`,
          line: { color: colour(signal.colour), width: panel.isStacked ? 0.5 : 1.5,
            dash: signal.dash },
          stackgroup: panel.isStacked ? `stack${number}` : undefined,
          hovertemplate: `%{y:.4~r} ${panel.unit}` });
      }
    });
    return { data, layout: laid };
  };

  async function reload(begin = range?.[0] ?? null, end = range?.[1] ?? null) {
    series = await api(source(begin, end, points)).catch((error) => {
      if (error.status === 409) return series;  // no rows yet
      throw error;
    });
    const last = series?.end_s.at(-1) ?? -Infinity;
    for (const [, line] of live) {
      const keep = line.x.findIndex((time) => time > last);
      if (end !== null || keep < 0) { line.x = []; line.y = []; } else {
        line.x = line.x.slice(keep);
        line.y = line.y.slice(keep);
      }
    }
    await plot(place, make);
  }

  let wanted = null;
  await reload();
  place.on("plotly_relayout", (changed) => {
    const begin = changed["xaxis.range[0]"], end = changed["xaxis.range[1]"];
    if (begin !== undefined) range = [begin, end];
    else if (changed["xaxis.autorange"]) range = null;
    else return;
    clearTimeout(wanted);
    wanted = setTimeout(() => reload(...(range ?? [null, null])), 120);
  });

  /** Add new rows; `window` is the number of latest seconds kept visible. */
  function add(columns, window = null) {
    const times = columns.time_s, from = series?.end_s.at(-1) ?? -Infinity;
    const xs = [], ys = [];
    for (const signal of names) {
      const line = live.get(signal.name), x = [], y = [];
      times.forEach((time, at) => {
        if (time <= (line.x.at(-1) ?? from)) return;
        const value = columns[signal.name][at];
        x.push(time);
        y.push(value === null ? null : value * (signal.scale ?? 1));
      });
      line.x.push(...x);
      line.y.push(...y);
      if (line.x.length > 6000) { line.x.splice(0, 3000); line.y.splice(0, 3000); }
      xs.push(x);
      ys.push(y);
    }
    Plotly.extendTraces(place, { x: xs, y: ys }, names.map((_, at) => at), 12_000);
    const last = times.at(-1), changes = {};
    panels.forEach((panel, row) => {
      const number = row ? row + 1 : "", end = panel.top?.(greatest);
      if (end) changes[`yaxis${number}.range`] = [0, end];
      if (window && !range) changes[`xaxis${number}.range`] = [Math.max(0, last - window), Math.max(window, last)];
    });
    if (Object.keys(changes).length) Plotly.relayout(place, changes);
  }

  return { reload, redraw: () => place.redraw(), add, Plotly };
}

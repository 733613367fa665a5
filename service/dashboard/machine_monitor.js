// A real machine, live, through the monitor of its MTConnect agent, beside a prediction.

import { AWAY_WORDS, announce, api, byId, duration, el, fill, fixed, moment, number, tell, watchAt }
  from "/dashboard/app.js";
import { programOf } from "/dashboard/records.js";
import { monitorChart, monitorKeys, WINDOWS } from "/dashboard/machine_monitor_chart.js";
import { comparisonTable } from "/dashboard/machine_compare.js";
import { measured, placesOf, unitOf } from "/dashboard/units.js";

const FLUSH = 500, COMPARE = 2000;

/** messages that may wait while the page is hidden, before the rows are read again instead */
const MOST_WAITING = 300;

/** CSS classes of lamps by execution; others are idle */
const LAMPS = { ACTIVE: "safe", WAIT: "wait", FEED_HOLD: "wait", INTERRUPTED: "wait",
  OPTIONAL_STOP: "wait", PROGRAM_STOPPED: "over" };

/** Readings: id, label, unit, formatting of a row's value; large ones first. */
const READINGS = [
  ["real-feed-commanded", "Feed commanded", unitOf("mm/min"), (row) => number(measured(row.feed_programmed_mm_min, "mm/min"), 4), "big"],
  ["real-feed-actual", "Feed actual", unitOf("mm/min"), (row) => number(measured(row.feed_actual_mm_min, "mm/min"), 4), "big"],
  ["real-power", "Total power", "kW", (row) => fixed(kilo(row.total_power_w), 2), "big"],
  ["real-x", "X", unitOf("mm"), (row) => fixed(measured(row.x_mm, "mm"), placesOf(2, "mm"))],
  ["real-y", "Y", unitOf("mm"), (row) => fixed(measured(row.y_mm, "mm"), placesOf(2, "mm"))],
  ["real-z", "Z", unitOf("mm"), (row) => fixed(measured(row.z_mm, "mm"), placesOf(2, "mm"))],
  ["real-spindle", "Spindle", "rpm", (row) => number(row.spindle_speed_rpm, 4)],
  ["real-spindle-power", "Spindle power", "kW", (row) => fixed(kilo(row.spindle_power_w), 2)],
  ["real-tool", "Tool", "", (row) => (row.tool ? `T${row.tool}` : "–")],
  ["real-force", "Cutting force", "N", (row) => number(row.cutting_force_n, 3)],
];
const kilo = (value) => (value === null || value === undefined ? null : value / 1000);

/** Show a monitored machine; returns a function that stops showing it. */
export function showMonitor(place, name, { programs, prediction = "" }) {
  const path = `/v1/monitors/${encodeURIComponent(name)}`;
  let status = null, heard = Date.now(), isAway = false, isShut = false, isHeld = false;
  let waiting = [], chart = null, zero = null, compared = 0, shown = "", isBusy = false, isBehind = false;

  const banner = el("div", { id: "monitor-banner" }), trouble = el("div", { id: "monitor-problem" });
  const lamp = el("span", { class: "lamp idle", id: "real-execution" }, "–");
  const link = el("span", { class: "badge", id: "real-state" }, "–");
  const step = el("span", { id: "real-workingstep" }, "–");
  const facts = el("span", { class: "soft small", id: "real-facts" });
  const values = new Map();
  const readings = READINGS.map(([id, label, unit, , kind = ""]) => {
    const value = el("span", { class: "value", id }, "–");
    values.set(id, value);
    return el("div", { class: `figure ${kind}` }, el("div", { class: "name" }, label),
      el("div", {}, value, el("span", { class: "unit" }, unit)));
  });
  const board = el("div", { id: "real-values" },
    el("div", { class: "row", id: "now" }, lamp, link, step),
    el("div", { class: "figures" }, readings.filter((each) => each.classList.contains("big"))),
    el("div", { class: "readings" }, readings.filter((each) => !each.classList.contains("big"))));
  const choice = el("select", { id: "prediction", onfocus: listPredictions,
    onchange: () => choose(choice.value) }, el("option", { value: "" }, "none"));
  const span = el("select", { id: "real-window", onchange: () => chart?.follow(Number(span.value)) },
    WINDOWS.map(([seconds, text]) => el("option", { value: seconds }, text)));
  const drawn = el("div", { class: "chart", id: "real-chart", role: "figure",
    "aria-label": "position, feed, spindle power and total power over time, measured and predicted" });
  const table = el("div", { id: "comparison" });
  const hold = () => { isHeld = true; }, release = () => { isHeld = false; };
  drawn.addEventListener("pointerdown", hold, true);
  window.addEventListener("pointerup", release, true);
  window.addEventListener("pointercancel", release, true);

  fill(place,
    el("section", { class: "card", "aria-labelledby": "real-title" },
      el("div", { class: "row spread" }, el("h2", { id: "real-title" }, name), facts),
      banner, trouble, board),
    el("section", { class: "card", "aria-labelledby": "real-signals" },
      el("h2", { id: "real-signals" }, "Measured and predicted"),
      el("div", { class: "row no-print" },
        el("label", { class: "grow" }, "Prediction: finished simulation of this machine", choice),
        el("label", {}, "Time shown", span),
        el("a", { class: "button", id: "verify-monitor",
          href: `/dashboard/verify.html?monitor=${encodeURIComponent(name)}` }, "Verify the latest run")),
      monitorKeys(), drawn,
      el("p", { class: "soft small" }, "Drag across a range to zoom in; double-click to follow the machine again.")),
    table);

  // -- state ------------------------------------------------------------------------------------

  function hear(now) {
    const isAnew = zero !== null && now.time_zero !== zero;
    status = now;
    zero = now.time_zero;
    lamp.textContent = now.execution?.replaceAll("_", " ") ?? now.availability ?? "–";
    lamp.className = `lamp ${LAMPS[now.execution] ?? "idle"}`;
    link.textContent = now.state === "never" ? "not connected yet" : now.state;
    step.textContent = now.workingstep || "outside workingsteps";
    facts.textContent = [now.program, now.url].filter(Boolean).join(" · ");
    chart?.mark(now.run);
    tellAge();
    if (isAnew) reload();
  }

  const age = () => (status?.age_s ?? 0) + (Date.now() - heard) / 1000;

  /** Say whether the values can be trusted; the words are announced once, the age is not. */
  function tellAge() {
    const [kind, tone, before, after] = verdict();
    for (const each of [board, drawn, table]) each.classList.toggle("old", tone === "warn");
    if (kind + after !== shown) {
      if (!kind && shown) announce(`data from ${name} arrive again`);
      shown = kind + after;
      fill(banner, kind ? el("div", { class: `banner ${tone}`, role: tone === "warn" ? "alert" : null }, before,
        el("span", { id: "monitor-age", "aria-live": "off" }), after) : null);
    }
    if (kind && byId("monitor-age")) byId("monitor-age").textContent = seconds(kind);
  }

  const seconds = (kind) => (["stale", "lost", "quiet", "away"].includes(kind) ? `${Math.round(age())} s` : "");

  /** Kind of the banner, its tone, and its words before and after the age. */
  function verdict() {
    if (isAway) return ["away", "warn", `${AWAY_WORDS} No data from ${name} for `, ": shown values are old."];
    if (!status) return ["", "", "", ""];
    const why = status.problem ? ` The connection is lost: ${status.problem}` : "";
    if (status.freshness === "none") {
      return ["none", "warn", `There is no connection to ${name} yet. ${status.problem ?? ""}`, ""];
    }
    if (status.freshness === "stale") {
      const kind = status.state === "lost" ? "lost" : "stale";
      return [kind, "warn", `No data from ${name} for `, `: shown values are old.${why}`];
    }
    if (status.availability === "UNAVAILABLE") {
      return ["unavailable", "warn", `${name} reports that it is UNAVAILABLE: shown values are old.`, ""];
    }
    if (status.freshness === "quiet") {
      return ["quiet", "", `${name} is at rest: no change for `, ". Its agent answers."];
    }
    return ["", "", "", ""];
  }

  function show(row) {
    for (const [id, , , words] of READINGS) values.get(id).textContent = words(row);
  }

  // -- rows -------------------------------------------------------------------------------------

  function flush() {
    if (!waiting.length || !chart || isHeld) return;
    const parts = waiting;
    waiting = [];
    const names = Object.keys(parts[0].columns);
    const columns = Object.fromEntries(names.map((key) => [key, parts.flatMap((part) => part.columns[key])]));
    show(Object.fromEntries(names.map((key) => [key, columns[key].at(-1)])));
    chart.add(columns);
  }

  async function reload() {
    if (!chart) return;
    waiting = [];
    isBehind = false;
    await chart.reload().catch((error) => tell(trouble, error));
    await compare();
  }

  const ticks = setInterval(() => {
    tellAge();
    if (document.visibilityState !== "visible") return;
    if (isBehind && chart) reload();
    flush();
    if (Date.now() - compared >= COMPARE) compare();
  }, FLUSH);

  const leave = watchAt(`${path}/events`, {
    status: (now) => { heard = Date.now(); isAway = false; hear(now); },
    rows: (rows) => {
      if (waiting.length >= MOST_WAITING) { waiting = []; isBehind = true; }
      waiting.push(rows);
    },
    gap: reload,
    lost: () => { isAway = true; tellAge(); },
    back: () => { isAway = false; reload(); },
  });

  // -- prediction -------------------------------------------------------------------------------

  /** List the finished simulations of this machine. */
  async function listPredictions() {
    const page = await api("/v1/jobs?kind=simulation&state=succeeded&limit=200");
    const own = page.items.filter((job) => job.request.machine === name);
    const chosen = choice.value || prediction;
    fill(choice, el("option", { value: "" }, own.length ? "none" : "none: simulate the program on this machine first"),
      own.map((job) => el("option", { value: job.id }, `${programOf(job, programs)}, ${moment(job.created_at)}`)));
    choice.value = own.some((job) => job.id === chosen) ? chosen : "";
  }

  async function choose(id) {
    const query = new URLSearchParams({ source: name, ...(id ? { prediction: id } : {}) });
    history.replaceState(null, "", `?${query}`);
    prediction = id;
    chart?.predict(id);
    if (!id) fill(table);
    await compare();
  }

  async function compare() {
    compared = Date.now();
    if (!choice.value || !chart || isBusy) return;
    isBusy = true;
    try {
      const found = await api(`${path}/comparison?simulation=${choice.value}`);
      if (isShut || found.simulation !== choice.value) return;
      comparisonTable(table, found, status?.run);
      await chart.align(found.parts);
    } catch (error) {
      if (!isAway) tell(trouble, error);
    } finally {
      isBusy = false;
    }
  }

  async function begin() {
    status = await api(path);
    heard = Date.now();
    hear(status);
    show(status.latest);
    chart = await monitorChart(drawn, path, Number(span.value));
    chart.mark(status.run);
    await listPredictions();
    await choose(choice.value);
  }
  begin().catch((error) => tell(trouble, error));

  return () => {
    isShut = true;
    leave();
    clearInterval(ticks);
    window.removeEventListener("pointerup", release, true);
    window.removeEventListener("pointercancel", release, true);
    drawn.redraw = null;
    chart?.purge();
  };
}

// One run of the virtual machine, live or recorded: its current state, and signals over time.

import { AWAY_WORDS, announce, api, byId, duration, el, fill, fixed, number, tell, watch }
  from "/dashboard/app.js";
import { timePanels } from "/dashboard/charts.js";
import { bar, hasShare, isOver, saying } from "/dashboard/records.js";
import { COMPONENTS, CONDITION, EXECUTION, LAMPS, PANELS, PATH_MODE, paceWord }
  from "/dashboard/machine_words.js";
import { results } from "/dashboard/machine_results.js";
import { measured, placesOf, unitOf } from "/dashboard/units.js";

const FLUSH = 250, STALE = 5000;

/** values of a machine whose program has ended, regardless of its last sample */
const AT_REST = { feed_actual_mm_min: 0, spindle_speed_rpm: 0, cutting_force_n: 0, path_mode: 0 };
const END_WORDS = { succeeded: "State at the end of the run", failed: "State when the run failed",
  cancelled: "State when the run was cancelled" };

/** Readings: id, label, unit, formatting of a row's value; large ones first. */
const READINGS = [
  ["now-feed-commanded", "Feed commanded", unitOf("mm/min"), (row) => number(measured(row.feed_programmed_mm_min, "mm/min"), 4), "big"],
  ["now-feed-actual", "Feed actual", unitOf("mm/min"), (row) => number(measured(row.feed_actual_mm_min, "mm/min"), 4), "big"],
  ["now-power", "Power from the mains", "kW", (row) => fixed(row.total_power_w / 1000, 2), "big"],
  ["now-time", "Machine time", "", (row) => duration(row.time_s)],
  ["now-x", "X", unitOf("mm"), (row) => fixed(measured(row.x_mm, "mm"), placesOf(2, "mm"))],
  ["now-y", "Y", unitOf("mm"), (row) => fixed(measured(row.y_mm, "mm"), placesOf(2, "mm"))],
  ["now-z", "Z", unitOf("mm"), (row) => fixed(measured(row.z_mm, "mm"), placesOf(2, "mm"))],
  ["now-spindle", "Spindle", "rpm", (row) => number(row.spindle_speed_rpm, 4)],
  ["now-tool", "Tool", "", (row) => (row.tool ? `T${row.tool}` : "none")],
  ["now-force", "Cutting force", "N", (row) => number(row.cutting_force_n, 3)],
  ["now-drive", "Spindle drive", "", (row) => CONDITION[row.overload] ?? "–"],
  ["now-energy", "Energy so far", "kJ", () => "–"],
];

/**
 * Show the run of a job; `told(job, isAgain)` receives the job, and whether it has been restarted,
 * which makes the displayed data invalid. Returns a function that stops showing it.
 */
export function showRun(place, first, told = () => {}) {
  let job = first, status = null, row = null, chart = null, energy = 0, energyAt = 0;
  let waiting = [], heard = Date.now(), isLost = false, isShut = false, isHeld = false, at = null, asked = 0;
  let end = Infinity, energyAtEnd = null;
  const path = `/v1/simulations/${job.id}`;

  const lamp = el("span", { class: "lamp idle", id: "now-execution" }, "–");
  const mode = el("span", { class: "badge", id: "now-mode" }, "–");
  const step = el("span", { id: "now-workingstep" }, "–");
  const stale = el("div", { id: "stale" }), trouble = el("div", { id: "run-problem" });
  const full = el("div", { class: "banner warn", id: "run-full", hidden: true },
    "The run has more rows than can be plotted: the plots end here, the run continues.");
  const line = hasShare(job) ? bar(job, { id: "run-progress" }) : null;
  const message = el("span", { class: "soft small", id: "run-message" });
  const cancel = el("button", { id: "run-cancel", onclick: () =>
    api(`/v1/jobs/${job.id}/cancel`, { method: "POST" }).then(hear, (error) => tell(trouble, error)) },
  "Cancel the run");
  const progress = el("div", { class: "row", id: "run-line" }, line, message, cancel);
  const values = new Map();
  const readings = READINGS.map(([id, name, unit, , kind = ""]) => {
    const value = el("span", { class: "value", id }, "–");
    values.set(id, value);
    return el("div", { class: `figure ${kind}` }, el("div", { class: "name" }, name),
      el("div", {}, value, el("span", { class: "unit" }, unit)));
  });
  const slider = el("input", { type: "range", min: "0", max: "1", step: "any", id: "at-time",
    oninput: () => goTo(Number(slider.value)) });
  const atLine = el("label", { class: "at no-print", hidden: true, id: "at-line" },
    el("span", { id: "at-words" }, "State at the end of the run"), slider);
  const drawn = el("div", { class: "chart", id: "run-chart", role: "figure",
    "aria-label": "power by component, feed commanded and actual, cutting force over time" });
  const outcome = el("div", { id: "results" });
  const hold = () => { isHeld = true; }, release = () => { isHeld = false; };
  drawn.addEventListener("pointerdown", hold, true);
  window.addEventListener("pointerup", release, true);
  window.addEventListener("pointercancel", release, true);

  fill(place,
    el("section", { class: "card", "aria-labelledby": "state-title" },
      el("div", { class: "row spread" }, el("h2", { id: "state-title" }, "State"),
        el("span", { class: "soft small", id: "run-facts" }, facts(job))),
      stale, trouble, full, progress,
      el("div", { class: "row", id: "now" }, lamp, mode, step),
      el("div", { class: "figures" }, readings.filter((each) => each.classList.contains("big"))),
      el("div", { class: "readings" }, readings.filter((each) => !each.classList.contains("big"))), atLine),
    el("section", { class: "card", "aria-labelledby": "chart-title" },
      el("h2", { id: "chart-title" }, "Signals"), keys(), drawn,
      el("p", { class: "soft small" }, "Drag across a range to zoom in; double-click to show the whole run. Click to show the state at that time.")),
    outcome);

  // -- now --------------------------------------------------------------------------------------

  function show(now) {
    row = now;
    message.textContent = "";
    showLamp(row.execution);
    mode.textContent = PATH_MODE[row.path_mode] ?? "–";
    step.textContent = stepName(row.workingstep);
    for (const [id, , , words] of READINGS) if (id !== "now-energy") values.get(id).textContent = words(row);
    values.get("now-drive").className = `value ${["", "warn", "bad"][row.overload] ?? ""}`;
  }

  function showLamp(execution) {
    lamp.textContent = EXECUTION[execution] ?? "–";
    lamp.className = `lamp ${LAMPS[execution] ?? "idle"}`;
  }

  /** Show the final state; the last sample is from just before the end. */
  function showEnd() {
    byId("at-words").textContent = `${END_WORDS[job.state]}; move the slider to look back`;
    if (job.state === "succeeded") {
      show({ ...row, ...AT_REST, execution: EXECUTION.indexOf("PROGRAM COMPLETED") });
      if (energyAtEnd !== null) tellEnergy(energyAtEnd);
      return;
    }
    lamp.textContent = job.state.toUpperCase();
    lamp.className = `lamp ${job.state === "failed" ? "over" : "idle"}`;
  }

  const stepName = (count) => (count ? status?.workingsteps?.[count - 1] ?? `workingstep ${count}` : "outside workingsteps");
  const tellEnergy = (joules) => { values.get("now-energy").textContent = number(joules / 1000, 4); };

  /** Read the energy up to a time, from the mean power of all rows until then. */
  async function energyUntil(time) {
    const query = new URLSearchParams({ signals: "total_power_w", points: "1" });
    if (time !== null) query.set("end_s", String(time));
    const found = await api(`${path}/series?${query}`);
    if (!found.rows) return [0, 0];
    return [found.signals.total_power_w.mean[0] * found.end_s[0], found.end_s[0]];
  }

  async function recount() {
    [energy, energyAt] = await energyUntil(null).catch(() => [energy, energyAt]);
    tellEnergy(energy);
  }

  /** Show the state of a recorded run at a time. */
  async function goTo(time) {
    const mine = asked += 1;
    at = time;
    const query = `points=2&begin_s=${Math.max(time - 1 / rate(), 0)}&end_s=${time + 1 / rate()}`;
    const [found, [joules]] = await Promise.all([api(`${path}/series?${query}`), energyUntil(time)])
      .catch((error) => { tell(trouble, error); return [null, [0]]; });
    if (!found?.rows || mine !== asked || isShut) return;
    const columns = Object.entries(found.signals).map(([name, { low }]) => [name, low[0]]);
    show({ time_s: time, ...Object.fromEntries(columns) });
    tellEnergy(joules);
    byId("at-words").textContent = `State at ${duration(time)}`;
    slider.setAttribute("aria-valuetext", duration(time));
    if (time >= end) showEnd();
    mark();
  }

  const rate = () => job.request.rate_hz ?? 20;

  function mark() {
    chart?.Plotly.relayout(drawn, { shapes: shapes() });
  }
  const shapes = () => (at === null ? [] : [{ type: "line", x0: at, x1: at, y0: 0, y1: 1,
    yref: "paper", line: { width: 1, dash: "dot", color: "gray" } }]);

  // -- the stream -------------------------------------------------------------------------------

  function flush() {
    // Redrawing would cancel a range selection in progress.
    if (!waiting.length || !chart || isHeld) return;
    const parts = waiting;
    waiting = [];
    const names = Object.keys(parts[0].columns);
    const columns = Object.fromEntries(names.map((name) =>
      [name, parts.flatMap((part) => part.columns[name])]));
    const isReduced = parts.some((part) => part.is_reduced);
    show(Object.fromEntries(names.map((name) => [name, columns[name].at(-1)])));
    const pace = job.request.pace;
    chart.add(columns, pace > 0 && pace <= 10 ? 60 * pace : null);
    if (isReduced) { recount(); return; }
    columns.time_s.forEach((time, index) => {
      if (time <= energyAt) return;
      energy += columns.total_power_w[index] * (time - energyAt);
      energyAt = time;
    });
    tellEnergy(energy);
  }

  function lost() {
    if (!isLost) {
      fill(stale, el("div", { class: "banner warn", role: "alert" }, `${AWAY_WORDS} `,
        el("span", { id: "stale-age", "aria-live": "off" })));
    }
    isLost = true;
    byId("stale-age").textContent = `The displayed data are ${Math.round((Date.now() - heard) / 1000)} s old.`;
  }

  function back() {
    if (isLost) announce("connection restored");
    isLost = false;
    fill(stale);
    chart?.reload().then(recount);
  }

  function hear(now) {
    const isAgain = job.attempt > 0 && now.attempt > job.attempt;
    job = now;
    told(job, isAgain);
    if (isShut) return;
    progress.hidden = isOver(job);
    if (line && job.state === "running") line.value = job.share;
    message.textContent = row ? "" : saying(job) || "starting";
    cancel.disabled = job.is_cancelling;
    if (!row) lamp.textContent = job.state.toUpperCase();
  }

  const ticks = setInterval(() => {
    if (document.visibilityState === "visible") flush();
    if (isLost && Date.now() - heard > STALE) lost();
  }, FLUSH);

  async function ended() {
    flush();
    job = await api(`/v1/jobs/${job.id}`).catch(() => job);
    if (isShut) return;
    hear(job);
    fill(stale);
    if (job.state === "failed") tell(trouble, Object.assign(new Error(), failure(job)));
    if (job.state === "cancelled") {
      fill(trouble, el("div", { class: "banner warn" }, "The run was cancelled; the data recorded until then are shown."));
    }
    await chart?.reload();
    await recount();
    const found = await api(`${path}/series?points=1&signals=tool`).catch(() => null);
    if (!found?.rows || isShut) return;
    [end] = found.end_s;
    slider.max = String(end);
    slider.value = slider.max;
    atLine.hidden = false;
    if (job.state === "succeeded") {
      const result = await results(outcome, job, (time) => { slider.value = String(time); goTo(time); })
        .catch((error) => tell(outcome, error));
      if (isShut) return;
      if (result) byId("run-facts").textContent = facts(job, result.machine);
      energyAtEnd = result?.total.energy_j.total ?? null;
      announce("the run has ended");
    }
    if (at === null) await goTo(end);
  }

  const leave = watch(job.id, {
    job: hear,
    status: (now) => { status = now; full.hidden = !now.is_series_full; if (row) step.textContent = stepName(row.workingstep); },
    rows: (rows) => { waiting.push(rows); begin(); },
    gap: () => { waiting = []; chart?.reload().then(recount); },
    any: () => { heard = Date.now(); },
    lost, back, end: () => begin().then(ended),
  });
  hear(job);

  const source = (begin, end, points) => {
    const names = PANELS.flatMap((panel) => panel.signals.map(({ name }) => name));
    const query = new URLSearchParams({ signals: names.join(","), points: String(points) });
    if (begin !== null) query.set("begin_s", String(begin));
    if (end !== null) query.set("end_s", String(end));
    return `${path}/series?${query}`;
  };
  let ready = null;
  /** Draw the chart as soon as there are data. */
  const begin = () => (ready ??= timePanels(drawn, source, PANELS, { points: 800, height: 170, shapes })
    .then(async (made) => {
      if (isShut) return;
      chart = made;
      drawn.on("plotly_click", ({ points: [point] }) => {
        if (!isOver(job)) return;
        slider.value = String(point.x);
        goTo(Number(point.x));
      });
      if (!isOver(job)) await recount();
    }).catch((error) => tell(trouble, error)));

  return () => {
    isShut = true;
    leave();
    clearInterval(ticks);
    window.removeEventListener("pointerup", release, true);
    window.removeEventListener("pointercancel", release, true);
    drawn.redraw = null;
    chart?.Plotly.purge(drawn);
  };
}

/** Summarise the request of a run in a line. */
function facts(job, known = "automatic machine") {
  const { machine, material, pace, kc_factor: factor, noise, has_lag: lag, has_wear: wear } = job.request;
  return [machine || known, material || "material of the program",
    paceWord(pace), factor !== 1 ? `k_c × ${factor}` : "", noise !== "none" ? `noise ${noise}` : "",
    lag ? "drive lag" : "", wear ? "tool wear" : ""].filter(Boolean).join(" · ");
}

function failure(job) {
  return { message: job.problem?.detail ?? "the run has failed" };
}

/** Create the legend of the colours. */
function keys() {
  const row = (title, signals) => el("ul", { class: "keys", "aria-label": title },
    el("li", {}, el("b", {}, title)), signals.map(({ label, colour, dash, isArea }) => el("li", {},
      el("span", { class: `swatch ${isArea ? "" : "line"} ${dash ? "dashed" : ""}`, "aria-hidden": "true",
        style: isArea ? `background: var(--${colour})` : `border-color: var(--${colour})` }), label)));
  return [row("Power", COMPONENTS.map((each) => ({ ...each, isArea: true }))), row("Feed", PANELS[1].signals)];
}

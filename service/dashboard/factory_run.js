// One run of a shop: its floor while it runs live, its figures at the end.

import { AWAY_WORDS, Problem, announce, api, byId, counted, el, figure, fill, fixed, number, save, show, tell, watch }
  from "/dashboard/app.js";
import { bar, confirmed, isOver, saying, stateBadge } from "/dashboard/records.js";
import { Floor } from "/dashboard/factory_floor.js";
import { resultTables, showLive } from "/dashboard/factory_tables.js";
import { Strip } from "/dashboard/factory_strip.js";
import { weekTime } from "/dashboard/factory_states.js";

const LOOK = 1000, TABLES = 500, HOUR = 3600;
const WINDOWS = [["1", "last hour"], ["8", "last 8 h"], ["24", "last 24 h"], ["", "whole run"]];
const PACES = ["1", "10", "60", "300", "1000"];

/** Figures of the line: id, name, unit, value of a status. */
const FIGURES = [
  ["throughput", "Throughput", "parts/h", ({ line }) => number(line.throughput_h, 3)],
  ["wip", "In the shop", "parts", ({ line }) => String(line.wip_parts)],
  ["good", "Good", "parts", ({ line }) => String(line.good)],
  ["lost", "Scrapped", "parts", ({ line }) => String(line.lost)],
  ["lead", "Lead time", "h", ({ line }) => number(line.lead_time_h, 3)],
  ["power", "Power now", "kW", ({ line }) => fixed(line.power_kw, 1)],
  ["energy", "Energy", "kWh", ({ line }) => number(line.energy_kwh, 4)],
  ["part-energy", "Energy a good part", "kWh", ({ line }) => number(line.energy_per_part_kwh, 3)],
];

/** Show the run of a job; `told(job)` receives its changes. Returns a function that stops showing it. */
export function showRun(place, first, told) {
  const path = `/v1/factories/${first.id}`, isLive = first.request.pace > 0;
  let job = first, status = null, strip = null, isShut = false, isReading = false, tabledAt = 0;

  const clock = el("span", { class: "value", id: "clock" }, "–"), day = el("span", { class: "soft", id: "clock-day" });
  const pace = el("select", { id: "pace", onchange: () => order({ pace: Number(pace.value) }) },
    [...new Set([...PACES, String(first.request.pace)])].map((each) => el("option", { value: each, selected: each === String(first.request.pace) }, `${each} ×`)));
  const end = el("button", { id: "end", onclick: finish }, isLive ? "End" : "Cancel");
  const trouble = el("div", { id: "run-trouble" }), stale = el("div", { id: "stale" });
  const figures = el("div", { class: "figures", id: "line-figures" });
  const floorPlace = el("div", { class: "floor", id: "floor" }), floor = new Floor(floorPlace, fail);
  const window_ = el("select", { id: "window", onchange: () => look(true) },
    WINDOWS.map(([value, words]) => el("option", { value, selected: value === "8" }, words)));
  const stripPlace = el("div", { class: "strip" }), log = el("ol", { class: "plain log", id: "log" });
  const tables = el("div", { class: "pieces", id: "live-tables" }), result = el("div", { class: "pieces", id: "result-place" });
  const state = el("div", { class: "row", id: "run-line" });
  const seen = el("div", { class: "pieces", hidden: true },
    el("section", { class: "card", "aria-label": "line" }, figures),
    el("section", { class: "card", "aria-label": "floor" }, floorPlace),
    el("section", { class: "card" },
      el("div", { class: "row spread" }, el("h2", {}, "States, power and stock over time"), el("label", { class: "inline" }, "Show", window_)),
      stripPlace),
    tables,
    el("section", { class: "card" }, el("h2", {}, "Events"), log));
  fill(place, el("section", { class: "card", "aria-label": "run" },
    el("div", { class: "row spread" },
      el("div", { class: "row" }, el("div", { class: "figure" }, el("div", { class: "name" }, "Clock of the shop"), el("div", {}, clock, " ", day)), state),
      el("div", { class: "row" }, isLive ? el("label", { class: "inline", id: "pace-label" }, "Pace", pace) : null, end)),
    trouble, stale), result, seen);

  async function order(json) {
    tell(trouble, null);
    try { await api(`${path}/changes`, { method: "POST", json }); } catch (error) { tell(trouble, error); }
  }

  async function finish() {
    if (isLive && status) {
      if (await confirmed("End the run?", ["Its figures are those until now."], "End")) await order({ is_ended: true });
      return;
    }
    await api(`${path}/cancel`, { method: "POST" }).catch((error) => tell(trouble, error));
  }

  async function fail(name) {
    const minutes = el("input", { id: "repair", type: "number", min: "0.1", max: "10000", step: "any", value: "30", required: true });
    const isSure = await confirmed(`Let ${name} fail?`, ["It stops at once, waits for a repair crew if the shop has one, and is repaired."],
      "Fail", [el("label", {}, "Repair, min", minutes)]);
    if (isSure) await order({ failure: { machine: name, repair_min: Number(minutes.value) } });
  }

  function take(now) {
    status = now;
    seen.hidden = false;
    clock.textContent = `${fixed(now.time_s / HOUR, 2)} h`;
    day.textContent = `of ${number(now.hours, 4)} h · ${weekTime(now.start_s + now.time_s)}`;
    if (!figures.children.length) {
      fill(figures, FIGURES.map(([id, name, unit]) => {
        const made = figure(name, "–", unit);
        made.id = `figure-${id}`;
        return made;
      }));
    }
    for (const [id, , , value] of FIGURES) byId(`figure-${id}`).querySelector(".value").textContent = value(now);
    floor.show(now, isLive && !isOver(job) && !now.is_done);
    if (performance.now() - tabledAt > TABLES || now.is_done) {
      tabledAt = performance.now();
      showLive(tables, now);
    }
    if (pace !== document.activeElement && now.pace) {
      const word = String(now.pace);
      if (![...pace.options].some(({ value }) => value === word)) pace.append(el("option", { value: word }, `${word} ×`));
      pace.value = word;
    }
    look(false);
  }

  /** Read states and series of the range that is shown. */
  async function look(isAsked) {
    if (!status || isShut || isReading || (!isAsked && performance.now() - (look.at ?? -LOOK) < LOOK)) return;
    isReading = true;
    look.at = performance.now();
    const begin = window_.value ? Math.max(0, status.time_s - HOUR * Number(window_.value)) : 0;
    try {
      const [states, series] = await Promise.all([
        api(`${path}/states?begin_s=${begin}&bars=600`),
        api(`${path}/series?signals=power_kw,wip_parts&begin_s=${begin}&points=500`)]);
      strip ??= new Strip(stripPlace);
      if (!isShut) strip.show(states, series);
    } catch (error) {
      if (!(error instanceof Problem)) fill(stale, el("div", { class: "banner warn" }, AWAY_WORDS));
    } finally { isReading = false; }
  }

  function note(event) {
    const isBad = ["failed", "refused"].includes(event.kind);
    log.prepend(el("li", { "data-kind": event.kind, class: isBad ? "bad" : "" },
      el("span", { class: "soft" }, `${fixed(event.time_s / HOUR, 2)} h `), event.text));
    while (log.children.length > 200) log.lastChild.remove();
    if (event.kind === "refused") tell(trouble, new Problem({ detail: event.text }, 0));
  }

  async function readLog() {
    const { events } = await api(`${path}/log`).catch(() => ({ events: [] }));
    fill(log);
    events.forEach((event) => { if (event.kind !== "refused") note(event); });
    if (!events.length) fill(log);
  }

  function showState() {
    end.hidden = isOver(job);
    byId("pace-label")?.toggleAttribute("hidden", isOver(job));
    const isBusy = !isOver(job) && !(isLive && status);
    fill(state, stateBadge(job), isBusy ? bar(job) : null, isBusy ? el("span", { class: "soft", id: "run-message" }, saying(job)) : null);
    if (job.state === "failed") tell(trouble, new Problem(job.problem ?? { detail: "the run has failed" }, 0));
    told(job);
  }

  async function showResult() {
    const found = await api(path), { machines } = status ?? { machines: [] };
    const names = machines.length ? machines.map(({ name }) => name) : [...new Set(found.states.map(({ machine }) => machine))];
    clock.textContent = `${fixed(found.ended_h, 2)} h`;
    const table = el("select", { id: "get-which", "aria-label": "machine" }, names.map((name) => el("option", { value: name }, name)));
    const parts = () => save(`${path}/parts/${encodeURIComponent(table.value)}`).catch((error) => tell(trouble, error));
    fill(result, el("section", { class: "card", id: "result", "aria-labelledby": "result-title" },
      el("h2", { id: "result-title" }, found.is_finished ? "Result: all orders finished" : "Result",
        found.replications > 1 ? `, ${found.replications} replications` : "", `, seed ${found.seed}`),
      el("div", { class: "row actions" },
        el("button", { class: "main", id: "get-report", onclick: () => show(`${path}/report`) }, "Report"),
        el("button", { id: "get-figures", onclick: () => save(`${path}/figures`) }, "Figures, CSV"),
        el("button", { id: "get-states", onclick: () => save(`${path}/samples`) }, "States, Parquet"),
        el("span", { class: "row" }, table, el("button", { id: "get-parts", onclick: parts }, "Parts, CSV"))),
      found.replications > 1 ? el("p", { class: "soft small" }, "± 95 % interval of the mean over replications; hours in states are of the first.") : null,
      resultTables(found)));
    announce("result of the shop");
  }

  const stop = watch(job.id, {
    job: (now) => { job = now; showState(); },
    status: take,
    event: note,
    gap: () => { readLog(); look(true); },
    any: () => fill(stale),
    lost: () => fill(stale, el("div", { class: "banner warn" }, AWAY_WORDS)),
    back: () => { fill(stale); readLog(); },
    end: async () => {
      job = await api(`/v1/jobs/${job.id}`).catch(() => job);
      const last = await api(`${path}/status`).catch(() => null);
      if (isShut) return;
      if (last) take(last);
      showState();
      await look(true);
      if (job.state === "succeeded") await showResult().catch((error) => tell(trouble, error));
    },
  });
  showState();
  if (isLive) {
    readLog();
    // A run that is over already has a status, but sends none.
    api(`${path}/status`).then((now) => { if (now && !status && !isShut) take(now); }).catch(() => {});
  }
  return () => { isShut = true; stop(); };
}

export const runTitle = (job) => {
  const { request } = job;
  const name = request.sample || (typeof request.shop === "string"
    ? /^\s*title\s*=\s*"([^"]*)"/m.exec(request.shop)?.[1] : request.shop?.title) || "own shop";
  return `${name}, ${request.pace > 0 ? "live" : counted(request.replications, "replication")}`;
};


// The control page: operator panel of the force control simulator.

import { announce, api, byId, duration, el, fill, fixed, moment, tell } from "/dashboard/app.js";
import { boundsOf } from "/dashboard/control_fields.js";
import { Log } from "/dashboard/control_log.js";
import { Alarms, operatorCard, question } from "/dashboard/control_operator.js";
import { Freshness, Output } from "/dashboard/control_output.js";
import { bookOf, paceField, programPanes, startPanes, trialPanes } from "/dashboard/control_panes.js";
import { Plots } from "/dashboard/control_plots.js";
import { PLACES, Run, newest, refusals } from "/dashboard/control_run.js";
import { addKey } from "/dashboard/keys.js";
import { programTitle } from "/dashboard/records.js";

const SOURCES = [["trial", "Trial cut"], ["control-run", "Program"]];

const state = { kind: "trial", run: null, draft: {}, panes: null, fresh: null, stop: "", program: "",
  refused: "" };
const output = new Output(ask), fresh = new Freshness(), plots = new Plots(), pace = paceField(ask);
const alarms = new Alarms(), operator = operatorCard(ask, alarms);
const log = new Log((events) => { plots.mark(events); alarm(events); });
let book = null, machines = [], materials = [];

// -- requests -----------------------------------------------------------------------------------

const fields = () => [...(state.panes?.fields ?? []), ...operator.fields, output.isOn, output.mode, pace];

/** Change an input of the run, or of the run to be started. */
function ask(name, value, isAtOnce = false) {
  const { run } = state;
  if (run && !run.isOver) { run.ask(name, value, isAtOnce); return; }
  const field = fields().find((each) => each.spec.name === name);
  const { low, high } = field.spec;
  if (typeof value === "number" && low !== undefined && !(low <= value && value <= high)) {
    field.refuse(`${value} is outside ${boundsOf(field.spec)}`);
  } else state.draft[name] = value;
  showFields();
}

function refused(name, text) {
  const field = fields().find((each) => each.spec.name === name);
  const bounds = field?.spec.low === undefined ? "" : ` (${boundsOf(field.spec)})`;
  const isAlso = state.refused === text;
  if (!isAlso) for (const each of fields()) each.refuse(null);
  state.refused = text;
  setTimeout(() => { state.refused = ""; }, 300);
  if (field) field.refuse(text.includes(" must be ") ? text : `${text}${bounds}`, isAlso);
  else tell(byId("trouble"), new Error(text));
}

async function start() {
  const isTrial = state.kind === "trial", { draft } = state;
  const { pace: factor, is_on: isOn, mode, ...inputs } = draft;
  const json = isTrial ? { inputs: { ...inputs, is_on: isOn, mode }, pace: factor }
    : { ...state.panes.body(), mode, pace: factor };
  tell(byId("trouble"), null);
  begin.disabled = true;
  try {
    const job = await api(PLACES[state.kind], { method: "POST", json,
      headers: { "idempotency-key": crypto.randomUUID?.() ?? String(Math.random()) } });
    await join(job);
    announce("run started");
  } catch (error) {
    for (const [name, text] of Object.entries(refusals(error, Object.keys(inputs)))) {
      if (error.body?.errors && name) refused(name, text);
      else { tell(byId("trouble"), error); break; }
    }
  } finally { showState(); }
}

async function order(json) {
  tell(byId("trouble"), null);
  try {
    await state.run.order(json);
  } catch (error) { tell(byId("trouble"), error); }
}

async function end() {
  const { run } = state;
  const isSure = await question("end-question", "End this run?",
    "It cannot be continued afterwards. Hold stops the feed and can be resumed.", "End it", "Go on");
  if (!isSure || run.isOver) return;
  if (run.kind === "trial" && run.job.state === "running" && run.status) { await order({ end: true }); return; }
  await api(`${run.place}/cancel`, { method: "POST" }).catch((error) => tell(byId("trouble"), error));
}

// -- display ------------------------------------------------------------------------------------

function showFields() {
  const { run, draft } = state, isLive = run && !run.isOver;
  const held = isLive ? run.held : draft;
  for (const field of fields()) {
    const { name } = field.spec;
    if (!held || !(name in held)) continue;
    const wanted = isLive ? run.wanted(name) : undefined;
    field.show(wanted ?? held[name], wanted !== undefined);
  }
  const isFree = !isLive || (run.status !== null && !run.status.is_done);
  if (state.isFree !== isFree) {
    state.isFree = isFree;
    state.panes?.enable(isFree);
    pace.enable(isFree);
    output.mode.enable(isFree);
    operator.fields[0].enable(isFree && Boolean(isLive));
  }
  output.isOn.enable(isFree && (isLive || state.kind === "trial"));
  if (held) state.panes?.fit(held);
}

/** State of the run as a word, with its tone and details. */
function condition() {
  const { run } = state;
  if (!run) return ["No run", "soft", ""];
  const { job, status } = run;
  if (job.state === "failed") return ["Failed", "bad", job.problem?.detail ?? ""];
  if (job.state === "cancelled") return ["Cancelled", "soft", ""];
  if (job.state === "queued") return ["Queued", "warn", ""];
  if (!run.isOver && state.fresh !== null) return ["No data", "bad", ""];
  if (status?.is_stopped) return ["Stopped by the loop", "bad", status.stopped_by || state.stop];
  if (run.isOver) return [run.kind === "trial" ? "Ended" : "Program finished", "soft", ""];
  if (!status) return ["Preparing", "warn", job.message];
  if (job.is_cancelling) return ["Ending", "warn", ""];
  if (status.is_held) return ["Held", "warn", "the feed is held by the operator"];
  return status.is_done ? ["Writing results", "warn", ""] : ["Running", "good", ""];
}

function showState() {
  const { run } = state, [word, tone, more] = condition(), isLive = Boolean(run) && !run.isOver;
  if (runState.textContent !== word) { runState.textContent = word; announce(`run: ${word}`); }
  runState.className = `badge ${tone}`;
  time.textContent = run?.status ? duration(run.status.time_s) : "–";
  begin.hidden = isLive;
  begin.disabled = !state.isReady || state.kind === "control-run" && Boolean(state.panes?.isEmpty);
  finish.hidden = !isLive;
  cutter.hidden = !(isLive && run.kind === "trial" && run.status?.is_stopped);
  stopped.hidden = !more;
  stopped.className = `banner ${tone === "bad" ? "bad" : "warn"}`;
  const text = word === "Stopped by the loop" ? `${word}: ${more}` : more;
  if (stopped.textContent !== text) stopped.textContent = text;
}

function showStatus() {
  const { run } = state, status = run?.status ?? null;
  output.show(status, Boolean(run?.isOver));
  operator.show(status, Boolean(run?.isOver));
  showFields();
  showState();
  const shown = state.panes?.told;
  if (!shown || !status) return;
  shown.program.show(state.program);
  shown.workingstep.show(status.workingstep);
  shown.tool.show(status.tool);
  shown.depth.show(fixed(status.axial_depth_mm, 2));
  shown.motor.show(fixed(status.motor_power_kw, 2));
  shown.done.show(fixed(100 * status.progress_share, 1));
}

const HEAR = {
  status: showStatus,
  rows: (rows) => plots.add(rows),
  event: (event) => { log.add(event); noteStop(event); },
  again: () => { plots.reload(); log.reload(); },
  refused,
  forbidden: (error) => tell(byId("trouble"), error),
  fresh: (age) => {
    const hasChanged = (age === null) !== (state.fresh === null);
    state.fresh = age;
    fresh.show(age, state.run?.isLost ?? false);
    if (hasChanged) showState();
  },
  job: () => {
    const isOver = state.run?.isOver;
    if (isOver && !state.wasOver) again();
    state.wasOver = isOver;
    showStatus();
  },
};

/** Raise the alarms of the run shown; only those of a running one are told aloud. */
function alarm(events) {
  alarms.show(state.run?.job.id ?? "", events, Boolean(state.run) && !state.run.isOver);
  operator.warn(events);
}

function noteStop(event) {
  if (["stop", "breakage", "lost"].includes(event.kind)) state.stop = event.text;
}

// -- choice of run ------------------------------------------------------------------------------

/** Build the panes for a kind of run; values of the last run are kept for the next. */
async function shape() {
  const { kind, run } = state, isLive = run && !run.isOver;
  output.shape(kind);
  operator.node.classList.toggle("of-trial", kind === "trial");
  for (const [name, button] of Object.entries(sources)) {
    button.setAttribute("aria-pressed", String(name === kind));
  }
  if (kind === "trial") state.panes = trialPanes(book, materials, ask);
  else if (isLive) state.panes = programPanes(book, materials, ask);
  else state.panes = startPanes(book, { ...(await programsAndAdvices()), machines, materials });
  if (run?.isOver) state.panes.preset?.(run.job.request);
  state.isFree = null;
  fill(panes, state.panes.nodes);
}

async function programsAndAdvices() {
  const [programs, jobs] = await Promise.all([api("/v1/programs?limit=200"),
    api("/v1/jobs?kind=advice&state=succeeded&limit=100")]);
  programs.items = programs.items.filter((each) => each.kind === "step-nc");
  const names = new Map(programs.items.map((each) => [each.id, each.name]));
  const advices = jobs.items.filter((job) => names.has(job.program_id)).map((job) => ({ id: job.id,
    title: [names.get(job.program_id), job.request.mode, job.request.machine, moment(job.created_at)]
      .filter(Boolean).join(", ") }));
  return { programs: programs.items.map((each) => ({ id: each.id, title: programTitle(each) })), advices };
}

function usual(kind) {
  return kind === "trial" ? { ...book.usual, pace: book.paceTrial }
    : { is_on: true, mode: book.usualRun.mode, pace: book.usualRun.pace };
}

/** After the end, keep the inputs for the next run. */
async function again() {
  const { run } = state;
  if (run.held) {
    const { mode, is_on: isOn, pace: factor } = run.held;
    state.draft = run.kind === "trial" ? { ...run.held } : { mode, is_on: isOn, pace: factor };
    for (const name of Object.keys(state.draft)) if (state.draft[name] === undefined) delete state.draft[name];
    state.draft.pace ??= run.job.request.pace || 1;
  }
  await shape();
  showStatus();
}

async function join(job) {
  state.run?.leave();
  Object.assign(state, { kind: job.kind, stop: "", wasOver: false, program: "", draft: usual(job.kind) });
  history.replaceState(null, "", `?id=${job.id}`);
  state.run = new Run(job, HEAR);
  runName.textContent = `run …${job.id.slice(-6)}`;
  runName.title = `run ${job.id}`;
  await shape();
  showStatus();
  const { run } = state, status = await api(`${run.place}/status`);
  if (run !== state.run) return;
  if (status) run.take(status);
  await Promise.all([plots.show(run.place, status !== null), log.show(run.place), nameProgram(job)]);
  log.events.forEach(noteStop);
  showStatus();
}

async function nameProgram(job) {
  if (!job.program_id) return;
  const program = await api(`/v1/programs/${job.program_id}`).catch(() => null);
  state.program = (program?.name ?? "deleted program") + (job.advice_id ? ", advised feeds" : "");
}

/** Without a run, edit the inputs of the next one. */
async function idle(kind) {
  state.run?.leave();
  Object.assign(state, { kind, run: null, stop: "", draft: usual(kind), fresh: null });
  fresh.show(null, false);
  history.replaceState(null, "", kind === "trial" ? location.pathname : "?source=program");
  runName.textContent = "";
  await shape();
  await Promise.all([plots.show(null), log.show(null)]);
  showStatus();
}

/** Show the newest running run of the chosen source, or none. */
async function choose(kind) {
  if (kind === state.kind) return;
  const going = await newest([kind]).catch(() => null);
  await (going ? join(going) : idle(kind));
}

// -- the page -----------------------------------------------------------------------------------

const sources = Object.fromEntries(SOURCES.map(([kind, text]) => [kind, el("button", { type: "button",
  id: kind === "trial" ? "source-trial" : "source-program", "aria-pressed": "false",
  onclick: () => choose(kind) }, text)]));
const runState = el("span", { class: "badge soft", id: "run-state" }, "…");
const runName = el("span", { class: "soft small", id: "run-name" });
const time = el("span", { id: "out-time_s", class: "value" }, "–");
const begin = el("button", { class: "main", id: "start", type: "button", disabled: true, onclick: start }, "Start");
const finish = el("button", { id: "end", type: "button", hidden: true, onclick: end }, "End");
const cutter = el("button", { class: "main", id: "new-cutter", type: "button", hidden: true,
  onclick: () => order({ restart: true }) }, "New cutter");
const stopped = el("div", { id: "stopped", class: "banner bad", role: "status", hidden: true });
const panes = el("div", { class: "panes", id: "panes" });

fill(byId("main"),
  el("div", { class: "title control-title" }, el("h1", {}, "Control"),
    el("div", { class: "switch small", role: "group", "aria-label": "source" }, Object.values(sources)),
    el("span", { class: "row tight" }, runState, runName),
    el("span", { class: "clock" }, el("span", { class: "soft" }, "machine time "), time),
    el("span", { class: "row tight commands" }, pace.node, begin, cutter, finish)),
  el("div", { id: "trouble" }), alarms.node, stopped, fresh.node,
  el("div", { class: "panel" }, el("div", { class: "seen" }, operator.node, output.node, plots.node),
    el("div", { class: "set" }, panes, log.node)), output.glance);

async function open() {
  const asked = new URLSearchParams(location.search);
  const id = asked.get("id") ?? asked.get("trial") ?? asked.get("run");
  const [document, ...shelves] = await Promise.all([api("/v1/openapi.json"), api("/v1/machines"),
    api("/v1/materials")]);
  book = bookOf(document);
  [machines, materials] = shelves;
  const wanted = id ? await api(`/v1/jobs/${id}`).catch((error) => { tell(byId("trouble"), error); return null; }) : null;
  if (wanted && wanted.kind in PLACES) { await join(wanted); return; }
  const isProgram = asked.get("source") === "program";
  const going = await newest(isProgram ? ["control-run"] : undefined);
  await (going ? join(going) : idle(isProgram ? "control-run" : "trial"));
}

addKey("h", "hold the feed of the program shown", () => byId("hold").click());

// Enable starting only now, because a run started earlier would not be shown.
open().then(() => { state.isReady = true; showState(); })
  .catch((error) => tell(byId("trouble"), error));

// The machine page: a run of the virtual machine, live or recorded, or a real machine, live.

import { api, byId, el, fill, moment, tell } from "/dashboard/app.js";
import { allPrograms, isOver, programOf, stateBadge } from "/dashboard/records.js";
import { showMonitor } from "/dashboard/machine_monitor.js";
import { paceWord } from "/dashboard/machine_words.js";
import { showRun } from "/dashboard/machine_run.js";
import { startForm } from "/dashboard/machine_start.js";

const asked = new URLSearchParams(location.search);
const known = new Map();
let programs = new Map(), leave = null, cursor = null;

const choice = el("select", { id: "run", onchange: () => open(known.get(choice.value)) });
const older = el("button", { id: "runs-older", hidden: true, onclick: () => list() }, "Older");
const badge = el("span", { id: "run-state" });
const starting = el("details", { id: "start-box" }, el("summary", {}, "Start a run"),
  el("div", { id: "start-place" }, el("p", { class: "soft" }, "…")));
// A choice before the page has opened what its address names would be undone.
const source = el("select", { id: "source", disabled: true, onchange: () => enter(source.value) });
const sourceCard = el("section", { class: "card", "aria-label": "choice of machine", hidden: true },
  el("div", { class: "row" }, el("label", { class: "grow" }, "Machine", source)));
const runCard = el("section", { class: "card", "aria-label": "choice of run" },
  el("div", { class: "row" }, el("label", { class: "grow" }, "Run", choice), older, badge), starting);
const trouble = el("div", { id: "problem" }), place = el("div", { id: "run-place", class: "pieces" });

fill(byId("main"),
  el("div", { class: "title" }, el("h1", {}, "Machine"),
    el("span", { class: "soft" }, "runs of the virtual machine, and real machines, live")),
  trouble, sourceCard, runCard, place);

const label = (job) => [programOf(job, programs), job.request.machine || "automatic machine",
  paceWord(job.request.pace), moment(job.created_at), isOver(job) ? "" : job.state,
  ["failed", "cancelled"].includes(job.state) ? job.state : ""].filter(Boolean).join(" · ");

function know(job, isFirst = false) {
  const option = choice.querySelector(`option[value="${job.id}"]`);
  if (option) option.textContent = label(job);
  else if (isFirst) choice.prepend(el("option", { value: job.id }, label(job)));
  else choice.append(el("option", { value: job.id }, label(job)));
  known.set(job.id, job);
}

/** Read the next page of runs. */
async function list() {
  const page = await api(`/v1/simulations?limit=50${cursor ? `&cursor=${cursor}` : ""}`);
  page.items.forEach((job) => know(job));
  cursor = page.next_cursor;
  older.hidden = !cursor;
}

function open(job) {
  leave?.();
  choice.value = job.id;
  history.replaceState(null, "", `?id=${job.id}`);
  leave = showRun(place, job, (now, isAgain) => {
    know(now);
    fill(badge, stateBadge(now));
    if (isAgain) open(now);
  });
}

/** Show a monitored machine, or without a name runs of the virtual machine. */
function enter(name, prediction = "") {
  leave?.();
  leave = null;
  source.value = name;
  runCard.hidden = Boolean(name);
  if (name) {
    leave = showMonitor(place, name, { programs, prediction });
    return;
  }
  history.replaceState(null, "", location.pathname);
  fill(place);
  const job = known.get(choice.value);
  if (job) open(job);
}

/** List the monitored machines, if there are any. */
async function listMonitors() {
  const monitors = await api("/v1/monitors");
  fill(source, el("option", { value: "" }, "virtual machine"),
    monitors.map(({ name, url }) => el("option", { value: name }, `${name}, MTConnect agent ${url}`)));
  sourceCard.hidden = !monitors.length;
  return monitors.map(({ name }) => name);
}

function started(job) {
  know(job, true);
  starting.open = false;
  open(job);
  byId("state-title").scrollIntoView({ block: "nearest" });
}

async function begin() {
  let monitors;
  [programs, monitors] = await Promise.all([allPrograms(), listMonitors()]);
  await list();
  const wanted = asked.get("id");
  if (wanted && !known.has(wanted)) {
    const job = await api(`/v1/jobs/${wanted}`);
    if (job.kind === "simulation") know(job, true);
  }
  const wish = { program: asked.get("program"), advice: asked.get("advice") };
  const isStart = Boolean(wish.program || wish.advice);
  const first = known.get(wanted) ?? (isStart ? null : [...known.values()][0]);
  const watched = monitors.includes(asked.get("source")) ? asked.get("source") : "";
  if (watched) {
    if (first) choice.value = first.id;
    enter(watched, asked.get("prediction") ?? "");
  } else if (first) open(first);
  else if (!isStart || !known.size) fill(place, el("p", { class: "card empty", id: "no-runs" }, "No runs yet: start one above."));
  if (!first) {
    starting.open = true;
    choice.prepend(el("option", { value: "", disabled: true }, known.size ? "choose a run" : "none yet"));
    choice.value = "";
  }
  choice.disabled = !known.size;
  source.disabled = false;
  await startForm(byId("start-place"), programs, wish, (job) => { choice.disabled = false; started(job); });
}

begin().catch((error) => tell(trouble, error));

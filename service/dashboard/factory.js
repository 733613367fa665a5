// The factory page: start a shop, watch its floor live, and read its figures.

import { api, byId, el, fill, moment, tell } from "/dashboard/app.js";
import { isOver } from "/dashboard/records.js";
import { runTitle, showRun } from "/dashboard/factory_run.js";
import { startForm } from "/dashboard/factory_start.js";

const known = new Map();
let leave = null, cursor = null;

const choice = el("select", { id: "run", onchange: () => open(known.get(choice.value)) });
const older = el("button", { id: "runs-older", hidden: true, onclick: () => list().catch((error) => tell(trouble, error)) }, "Older");
const starting = el("details", { id: "start-box" }, el("summary", {}, "Start a shop"),
  el("div", { id: "start-place" }, el("p", { class: "soft" }, "…")));
const trouble = el("div", { id: "problem" }), place = el("div", { id: "run-place", class: "pieces" });

fill(byId("main"),
  el("div", { class: "title" }, el("h1", {}, "Factory"),
    el("span", { class: "soft" }, "batches through machines and buffers, live or over replications")),
  trouble,
  el("section", { class: "card", "aria-label": "choice of run" },
    el("div", { class: "row" }, el("label", { class: "grow" }, "Run", choice), older), starting),
  place);

const label = (job) => [runTitle(job), moment(job.created_at),
  job.state === "succeeded" ? "" : job.state].filter(Boolean).join(" · ");

function know(job, isFirst = false) {
  const option = choice.querySelector(`option[value="${job.id}"]`);
  if (option) option.textContent = label(job);
  else if (isFirst) choice.prepend(el("option", { value: job.id }, label(job)));
  else choice.append(el("option", { value: job.id }, label(job)));
  known.set(job.id, job);
  choice.disabled = false;
}

/** Read the next page of runs. */
async function list() {
  const page = await api(`/v1/factories?limit=50${cursor ? `&cursor=${cursor}` : ""}`);
  page.items.forEach((job) => know(job));
  cursor = page.next_cursor;
  older.hidden = !cursor;
}

function open(job) {
  leave?.();
  choice.value = job.id;
  history.replaceState(null, "", `?id=${job.id}`);
  leave = showRun(place, job, (now) => know(now));
}

function started(job) {
  know(job, true);
  starting.open = false;
  open(job);
}

async function begin() {
  choice.disabled = true;
  await list();
  const wanted = new URLSearchParams(location.search).get("id");
  if (wanted && !known.has(wanted)) {
    const job = await api(`/v1/jobs/${wanted}`);
    if (job.kind === "factory") know(job, true);
  }
  const jobs = [...known.values()];
  const first = known.get(wanted) ?? jobs.find((job) => !isOver(job)) ?? jobs[0];
  if (first) open(first);
  else {
    starting.open = true;
    fill(place, el("p", { class: "card empty", id: "no-runs" }, "No shop has run yet: start one above."));
  }
  await startForm(byId("start-place"), started);
}

begin().catch((error) => tell(trouble, error));

// The jobs page: all jobs with their progress, refreshed while the page is visible.

import { announce, api, byId, duration, el, fill, moment, tell } from "/dashboard/app.js";
import { allPrograms, bar, confirmed, framed, hasShare, isOver, KINDS, programOf, saying, stateBadge, STATES }
  from "/dashboard/records.js";
import { paceWord } from "/dashboard/machine_words.js";

const APART = 1500, PAGE = 50;
const asked = new URLSearchParams(location.search);

let programs = new Map(), cursors = [null], timer = null, drawn = "", reading = 0;
const lines = new Map(), states = new Map();

const option = (value, text, chosen) => el("option", { value, selected: value === chosen }, text);
const kind = el("select", { id: "jobs-kind", onchange: afresh }, option("", "any", asked.get("kind") ?? ""),
  Object.entries(KINDS).map(([name, [text]]) => option(name, text, asked.get("kind"))));
const state = el("select", { id: "jobs-state", onchange: afresh }, option("", "any", asked.get("state") ?? ""),
  STATES.map((name) => option(name, name, asked.get("state"))));
const newer = el("button", { id: "jobs-newer", hidden: true, onclick: () => { cursors.pop(); look(); } }, "Newer");
const older = el("button", { id: "jobs-older", hidden: true, onclick: () => { cursors.push(older.cursor); look(); } }, "Older");
const trouble = el("div", { id: "problem" }), body = el("tbody", {}), when = el("span", { class: "soft small", id: "jobs-seen" });
const none = el("p", { class: "empty", id: "no-jobs", hidden: true });
const frame = framed("jobs", el("table", { id: "jobs" }, el("caption", { class: "unseen" }, "Jobs, newest first"),
  el("thead", {}, el("tr", {}, ["Kind", "State", "Program", "Progress", "Owner", "Created", "Duration"].map((text, at) =>
    el("th", { scope: "col", class: at === 6 ? "n" : "" }, text)), el("th", { scope: "col" }, el("span", { class: "unseen" }, "actions")))), body));

fill(byId("main"), el("div", { class: "title" }, el("h1", {}, "Jobs"), el("span", { class: "soft" }, "long work: queued, running, finished")),
  trouble, el("section", { class: "card", "aria-label": "jobs" },
    el("div", { class: "row spread" },
      el("div", { class: "row" }, el("label", { class: "inline" }, "Kind", kind), el("label", { class: "inline" }, "State", state)), when),
    frame, none, el("div", { class: "row end" }, newer, older)));

// -- refreshing -------------------------------------------------------------------------------

function afresh() {
  cursors = [null];
  const query = new URLSearchParams(Object.entries({ kind: kind.value, state: state.value }).filter(([, value]) => value));
  history.replaceState(null, "", query.size ? `?${query}` : location.pathname);
  look();
}

/** Read the displayed page, and refresh it later; not while the page is hidden. */
async function look() {
  clearTimeout(timer);
  const mine = reading += 1;
  const query = new URLSearchParams({ limit: String(PAGE) });
  for (const [name, value] of [["kind", kind.value], ["state", state.value], ["cursor", cursors.at(-1)]]) if (value) query.set(name, value);
  try {
    const page = await api(`/v1/jobs?${query}`);
    if (mine !== reading) return;
    if (page.items.some((job) => job.program_id && !programs.has(job.program_id) && !lines.has(job.id))) programs = await allPrograms();
    if (mine !== reading) return;
    draw(page);
    tell(trouble, null);
    when.textContent = `as of ${new Date().toLocaleTimeString("en-GB")}`;
    when.className = "soft small";
  } catch (error) {
    if (mine !== reading) return;
    if (!trouble.children.length) tell(trouble, error);
    when.className = "warn small";
  }
  if (document.visibilityState === "visible") timer = setTimeout(look, APART);
}

document.addEventListener("visibilitychange", () => {
  if (document.visibilityState === "visible") look();
  else clearTimeout(timer);
});

function draw(page) {
  older.cursor = page.next_cursor;
  older.hidden = !page.next_cursor;
  newer.hidden = cursors.length < 2;
  none.hidden = page.items.length > 0;
  frame.hidden = !page.items.length;
  none.textContent = kind.value || state.value ? "No job matches the filter." : "No jobs yet: request advice on the page Plan, or start a run on the page Machine.";
  const ids = page.items.map(({ id }) => id).join();
  for (const job of page.items) {
    tellChange(job);
    const line = lines.get(job.id) ?? made(job);
    line.update(job);
  }
  if (ids !== drawn) {
    const kept = document.activeElement;
    fill(body, page.items.map(({ id }) => lines.get(id).row));
    if (kept && body.contains(kept)) kept.focus();
    drawn = ids;
  }
}

/** Announce the end of a job that was running before. */
function tellChange(job) {
  const before = states.get(job.id);
  if (before && before !== job.state && isOver(job)) announce(`${KINDS[job.kind][0]} ${programOf(job, programs)} ${job.state}`);
  states.set(job.id, job.state);
}

// -- rows -------------------------------------------------------------------------------------

/** Create a row that is updated in place, so that it keeps the focus. */
function made(first) {
  const cells = { state: el("td", {}), how: el("td", { class: "jobs-how" }), took: el("td", { class: "n" }), acts: el("td", { class: "jobs-acts" }) };
  const row = el("tr", { id: `job-${first.id}`, "data-kind": first.kind },
    el("th", { scope: "row", class: "nowrap", title: first.id }, KINDS[first.kind][0]), cells.state,
    el("td", { class: "jobs-program" }, programOf(first, programs) || "–"), cells.how, el("td", {}, first.owner),
    el("td", { class: "nowrap" }, el("time", { datetime: first.created_at }, moment(first.created_at))), cells.took, cells.acts);
  let told = "";
  const line = { row, update(job) {
    cells.took.textContent = job.started_at ? duration(seconds(job)) : "–";
    row.dataset.state = job.state;
    const now = JSON.stringify([job.state, job.share, job.message, job.is_cancelling]);
    if (now === told) return;
    const before = told ? JSON.parse(told)[0] : null;
    told = now;
    fill(cells.state, stateBadge(job));
    fill(cells.how, how(job));
    if (before !== job.state || job.is_cancelling) fill(cells.acts, el("div", { class: "row end-row" }, acts(job)));
  } };
  lines.set(first.id, line);
  return line;
}

const seconds = (job) => ((job.ended_at ? new Date(job.ended_at) : new Date()) - new Date(job.started_at)) / 1000;

function how(job) {
  if (job.state === "failed") return el("span", { class: "bad small" }, job.problem?.detail ?? job.problem?.title ?? "");
  if (job.state === "queued") return el("span", { class: "soft small" }, saying(job));
  if (job.state === "cancelled") return el("span", { class: "soft small" }, ended(job));
  if (job.state === "succeeded") return el("span", { class: "soft small" }, gist(job));
  if (!hasShare(job)) return el("span", { class: "soft small" }, saying(job) || "paced run");
  return [bar(job), el("div", { class: "soft small" }, saying(job) || "starting")];
}

function ended(job) {
  if (!job.started_at) return "cancelled before it started";
  return job.share && !job.request.pace ? `cancelled at ${Math.round(100 * job.share)} %` : "cancelled";
}

/** Summarise the request of a job. */
function gist({ request, kind }) {
  const { mode, machine, material, tool, program, pace, law, grouping, only } = request;
  const of = [machine, material, tool, program].filter(Boolean);
  if (kind === "evaluation") of.push(grouping === "kind" ? "by kind of feature" : "by feature", only === "all" ? "" : only);
  if (kind === "evaluation" || kind === "review") return of.filter(Boolean).join(" · ") || "all outcomes";
  if (kind === "verification") return [...of, request.monitor ? "monitored machine" : request.run_id ? "samples of a run" : "log",
    `tolerance ${request.tolerance_mm} mm`].filter(Boolean).join(" · ");
  return [mode, ...of, law, pace === undefined ? "" : paceWord(pace)].filter(Boolean).join(" · ");
}

function acts(job) {
  const [word, place] = KINDS[job.kind], label = `${word} ${programOf(job, programs)}`.trim();
  const isShown = job.state === "succeeded" || ["simulation", "control-run", "trial"].includes(job.kind);
  const found = [];
  if (isShown && job.state !== "queued") found.push(el("a", { class: "button small", href: place(job.id), "aria-label": `open ${label}` }, "Open"));
  if (!isOver(job)) {
    found.push(el("button", { class: "small", disabled: job.is_cancelling, "aria-label": `cancel ${label}`, "data-act": "cancel",
      onclick: () => doing(() => api(`/v1/jobs/${job.id}/cancel`, { method: "POST" }), `${label} is being cancelled`) }, "Cancel"));
  } else {
    found.push(el("button", { class: "small", "aria-label": `delete ${label}`, "data-act": "delete", onclick: () => remove(job, label) }, "Delete"));
  }
  return found;
}

async function remove(job, label) {
  const texts = [`${label}, ${moment(job.created_at)}: its results, samples and reports are deleted.`,
    ["control-run", "evaluation", "review"].includes(job.kind) ? "Entries of the knowledge base are kept." : "This cannot be undone."];
  if (await confirmed("Delete a job", texts, "Delete")) {
    await doing(() => api(`/v1/jobs/${job.id}`, { method: "DELETE" }), `${label} was deleted`);
    lines.delete(job.id);
  }
}

async function doing(work, said) {
  try {
    await work();
    announce(said);
    await look();
  } catch (error) {
    tell(trouble, error);
  }
}

look();

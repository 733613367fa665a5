// Shared by the pages of runs, knowledge and jobs: names of programs, states of jobs, tables.

import { api, el, moment } from "/dashboard/app.js";

/** Names of job kinds, and the page that shows their result. */
export const KINDS = {
  "advice": ["advice", (id) => `/dashboard/plan.html?advice=${id}`],
  "simulation": ["simulation", (id) => `/dashboard/machine.html?id=${id}`],
  "control-run": ["control run", (id) => `/dashboard/control.html?id=${id}`],
  "trial": ["trial", (id) => `/dashboard/control.html?trial=${id}`],
  "evaluation": ["evaluation", (id) => `/dashboard/knowledge.html?evaluation=${id}`],
  "verification": ["verification", (id) => `/dashboard/verify.html?id=${id}`],
  "cycle-time": ["cycle time", (id) => `/dashboard/verify.html?cycle=${id}`],
  "factory": ["factory", (id) => `/dashboard/factory.html?id=${id}`],
  "review": ["review", (id) => `/dashboard/knowledge.html?review=${id}`],
};

export const STATES = ["queued", "running", "succeeded", "failed", "cancelled"];

export const isOver = (job) => !["queued", "running"].includes(job.state);

const TONES = { queued: "soft", running: "accent", succeeded: "good", failed: "bad", cancelled: "warn" };

/** Create a badge with the state of a job. */
export function stateBadge(job) {
  const word = job.is_cancelling && !isOver(job) ? "cancelling" : job.state;
  return el("span", { class: `badge ${TONES[job.state]}` }, word);
}

/** Whether the share of a job is its progress; that of a paced run is the progress of its planning. */
export const hasShare = (job) => !(job.request.pace > 0);

/** Create a progress bar of a job. */
export function bar(job, more = {}) {
  const value = job.state === "queued" ? undefined : String(job.share);
  return el("progress", { max: "1", value, "aria-label": "progress", ...more });
}

/** Return the message of a job without the percentage, which the bar shows. */
export const saying = (job) => (job.state === "queued" ? "queued" : job.message.replace(/^\d+ ?%\s*/, ""));

/** Read all programs, newest first, into a map by id. */
export async function allPrograms() {
  const programs = new Map();
  for (let cursor = null, pages = 0; pages < 4; pages += 1) {
    const page = await api(`/v1/programs?limit=500${cursor ? `&cursor=${cursor}` : ""}`);
    for (const program of page.items) programs.set(program.id, program);
    cursor = page.next_cursor;
    if (!cursor) break;
  }
  return programs;
}

/** Return a title that distinguishes programs of the same name. */
export const programTitle = ({ name, created_at: at }) => `${name}, ${moment(at)}`;

/** Return the name of the program of a job. */
export function programOf(job, programs) {
  if (!job.program_id) return "";
  const name = programs.get(job.program_id)?.name ?? "deleted program";
  return job.advice_id ? `${name}, optimised` : name;
}

/** Wrap a table in a frame that scrolls, also with the keyboard. */
export function framed(caption, table) {
  return el("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": caption }, table);
}

/** Ask for confirmation of a change; true when confirmed. `more` are fields of the form. */
export function confirmed(title, texts, word, more = []) {
  return new Promise((resolve) => {
    let isSure = false;
    const dialog = el("dialog", { "aria-labelledby": "confirm-title", id: "confirm" },
      el("h2", { id: "confirm-title" }, title), texts.map((text) => el("p", {}, text)),
      el("form", { method: "dialog", onsubmit: () => { isSure = true; } }, more,
        el("p", { class: "row end" },
          el("button", { type: "button", id: "confirm-no", onclick: () => dialog.close() }, "Cancel"),
          el("button", { class: "main", id: "confirm-yes" }, word))));
    dialog.addEventListener("close", () => { dialog.remove(); resolve(isSure); });
    document.body.append(dialog);
    dialog.showModal();
  });
}

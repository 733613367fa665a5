// What the pages of runs, knowledge and jobs share: names of programs, states of jobs, tables.

import { api, el, moment } from "/dashboard/app.js";

/** Kinds of jobs as people call them, and the page that shows what came out. */
export const KINDS = {
  "advice": ["advice", (id) => `/dashboard/plan.html?advice=${id}`],
  "simulation": ["simulation", (id) => `/dashboard/machine.html?id=${id}`],
  "control-run": ["control run", (id) => `/dashboard/control.html?id=${id}`],
  "trial": ["trial", (id) => `/dashboard/control.html?trial=${id}`],
  "evaluation": ["evaluation", (id) => `/dashboard/knowledge.html?evaluation=${id}`],
  "review": ["review", (id) => `/dashboard/knowledge.html?review=${id}`],
};

export const STATES = ["queued", "running", "succeeded", "failed", "cancelled"];

export const isOver = (job) => !["queued", "running"].includes(job.state);

const TONES = { queued: "soft", running: "accent", succeeded: "good", failed: "bad", cancelled: "warn" };

/** How far a job is, as a word. */
export function stateBadge(job) {
  const word = job.is_cancelling && !isOver(job) ? "cancelling" : job.state;
  return el("span", { class: `badge ${TONES[job.state]}` }, word);
}

/** Whether the share of a job tells how far it is: that of a run with a pace tells of its plan. */
export const hasShare = (job) => !(job.request.pace > 0);

/** How far a job is, as a bar. */
export function bar(job, more = {}) {
  const value = job.state === "queued" ? undefined : String(job.share);
  return el("progress", { max: "1", value, "aria-label": "how far it is", ...more });
}

/** What a job says of itself; the bar tells the share. */
export const saying = (job) => (job.state === "queued" ? "waits for its turn" : job.message.replace(/^\d+ ?%\s*/, ""));

/** All programs by id, newest first. */
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

/** A program among others of its name. */
export const programTitle = ({ name, created_at: at }) => `${name}, ${moment(at)}`;

/** What a job works on. */
export function programOf(job, programs) {
  if (!job.program_id) return "";
  const name = programs.get(job.program_id)?.name ?? "deleted program";
  return job.advice_id ? `${name}, optimised` : name;
}

/** A table in a frame that scrolls by itself, also with the keyboard. */
export function framed(caption, table) {
  return el("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": caption }, table);
}

/** Ask before something is changed: true when it was confirmed. `more` are fields of the form. */
export function confirmed(title, texts, word, more = []) {
  return new Promise((resolve) => {
    let isSure = false;
    const dialog = el("dialog", { "aria-labelledby": "confirm-title", id: "confirm" },
      el("h2", { id: "confirm-title" }, title), texts.map((text) => el("p", {}, text)),
      el("form", { method: "dialog", onsubmit: () => { isSure = true; } }, more,
        el("p", { class: "row end" },
          el("button", { type: "button", id: "confirm-no", onclick: () => dialog.close() }, "Leave it"),
          el("button", { class: "main", id: "confirm-yes" }, word))));
    dialog.addEventListener("close", () => { dialog.remove(); resolve(isSure); });
    document.body.append(dialog);
    dialog.showModal();
  });
}

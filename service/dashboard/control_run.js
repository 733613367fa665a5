// A run as seen by the panel: confirmed inputs, pending requests, age of the data.

import { Problem, api, watch } from "/dashboard/app.js";
import { same } from "/dashboard/control_fields.js";

export const PLACES = { "trial": "/v1/trials", "control-run": "/v1/control-runs" };

const DEBOUNCE_MS = 250, PATIENT_MS = 5000, STALE_MS = 2000, LOOK_MS = 250;

export const isOver = (job) => !["queued", "running"].includes(job.state);

/** Return the newest unfinished run of one kind or of both; null if there is none. */
export async function newest(kinds = Object.keys(PLACES)) {
  const pages = await Promise.all(kinds.map((kind) => api(`${PLACES[kind]}?limit=20`)));
  const going = pages.flatMap((page) => page.items).filter((job) => !isOver(job));
  going.sort((one, other) => other.created_at.localeCompare(one.created_at));
  return going[0] ?? null;
}

/** Return the messages of a problem by input name; `""` for those of no particular input. */
export function refusals(error, names) {
  const found = {};
  for (const one of error.body?.errors ?? []) {
    const name = names.find((each) => one.place.split(".").includes(each));
    if (name) found[name] = one.message;
  }
  if (Object.keys(found).length) return found;
  const text = error instanceof Problem ? error.message : "the service does not answer";
  return Object.fromEntries((names.length ? names : [""]).map((name) => [name, text]));
}

/**
 * A watched run. `hear`: {status, rows, event, job, again, refused(name, text),
 * forbidden(error), fresh(age)}: `again` when messages were missed, `forbidden` when the key is not
 * sufficient, `fresh` with the age of the data in s, null while they are new.
 */
export class Run {
  constructor(job, hear) {
    this.job = job;
    this.kind = job.kind;
    this.status = null;
    this.place = `${PLACES[job.kind]}/${job.id}`;
    this.isLost = false;
    this.asked = new Map();
    this.hear = hear;
    this.heard = performance.now();
    this.stop = watch(job.id, {
      job: (now) => { this.job = now; hear.job(now); },
      status: (status) => this.take(status),
      rows: (rows) => hear.rows(rows),
      event: (event) => { this.blame(event); hear.event(event); },
      gap: () => hear.again(),
      any: () => { this.heard = performance.now(); this.isLost = false; this.look(); },
      lost: () => { this.isLost = true; this.look(); },
      back: () => { hear.again(); },
      end: () => this.end(),
    });
    this.timer = setInterval(() => this.look(), LOOK_MS);
  }

  get isOver() { return isOver(this.job); }

  /** Whether new data are expected continuously. */
  get goesOn() { return this.job.state === "running" && this.status !== null && !this.status.is_done; }

  /** Confirmed values, by the name of the input. */
  get held() { return this.status ? { ...this.status.inputs, pace: this.status.pace } : null; }

  /** Requested value that is not confirmed yet; undefined if none. */
  wanted(name) { return this.asked.get(name)?.value; }

  take(status) {
    // The status in a result lacks the fields of a running run.
    this.status = { ...this.status, ...status };
    const held = this.held;
    for (const [name, order] of this.asked) {
      if (!order.sentAt) continue;
      if (same(held[name], order.value)) this.asked.delete(name);
      else if (performance.now() - order.sentAt > PATIENT_MS) this.refuse(name, "the run has not confirmed the change");
    }
    this.hear.status(this.status);
  }

  /** Request another value, shortly or at once; several requests are sent together. */
  ask(name, value, isAtOnce = false) {
    this.asked.set(name, { value, sentAt: null });
    clearTimeout(this.soon);
    if (isAtOnce) this.send();
    else this.soon = setTimeout(() => this.send(), DEBOUNCE_MS);
    this.hear.status(this.status);
  }

  async send() {
    const orders = [...this.asked].filter(([, order]) => order.sentAt === null);
    if (!orders.length) return;
    for (const [, order] of orders) order.sentAt = performance.now();
    const values = Object.fromEntries(orders.map(([name, order]) => [name, order.value]));
    const { pace, ...inputs } = values;
    const json = this.kind === "trial" ? { inputs } : { ...inputs };
    if (pace !== undefined) json.pace = pace;
    try {
      await this.order(json);
      for (const [, order] of orders) order.sentAt = performance.now();
    } catch (error) {
      if (error.status === 403) this.hear.forbidden(error);
      const told = refusals(error, Object.keys(values));
      // The body is refused as a whole: send the valid inputs again without the invalid ones.
      for (const [name, order] of orders) {
        if (this.asked.get(name) !== order) continue;
        if (name in told) this.refuse(name, told[name]);
        else order.sentAt = null;
      }
      this.hear.status(this.status);
      if ([...this.asked.values()].some((order) => order.sentAt === null)) await this.send();
    }
  }

  order(json) { return api(`${this.place}/changes`, { method: "POST", json }); }

  refuse(name, text) {
    this.asked.delete(name);
    this.hear.refused(name, text);
  }

  /** Report an order that the run could not carry out. */
  blame(event) {
    if (event.kind !== "refused") return;
    for (const name of [...this.asked.keys()]) this.refuse(name, event.text);
    this.hear.status(this.status);
  }

  look() {
    const age = performance.now() - this.heard;
    const isStale = !this.isOver && (this.isLost || (this.goesOn && age > STALE_MS));
    this.hear.fresh(isStale ? age / 1000 : null);
  }

  async end() {
    this.leave();
    this.job = await api(`/v1/jobs/${this.job.id}`).catch(() => this.job);
    const last = await api(`${this.place}/status`).catch(() => null);
    this.asked.clear();
    this.hear.fresh(null);
    if (last) this.take(last);
    this.hear.job(this.job);
    this.hear.again();
  }

  /** Stop watching; the run continues. */
  leave() {
    this.stop();
    clearTimeout(this.soon);
    clearInterval(this.timer);
  }
}

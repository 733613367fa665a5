// Event log of a run, newest first.

import { announce, api, el, fixed } from "/dashboard/app.js";
import { TONES } from "/dashboard/control_pen.js";

const MOST = 300, APART_MS = 4000;
const nameOf = (event) => `${event.time_s}|${event.kind}|${event.text}`;

export class Log {
  /** `changed(events)` receives all events, oldest first. */
  constructor(changed) {
    this.changed = changed;
    this.events = [];
    this.known = new Set();
    this.fresh = [];
    this.list = el("ol", { id: "log", class: "log", reversed: true });
    this.empty = el("p", { class: "empty", id: "log-empty" }, "No events yet.");
    this.count = el("span", { class: "soft small", id: "log-count" });
    this.node = el("section", { class: "card", id: "log-card", "aria-labelledby": "log-title" },
      el("div", { class: "row spread" }, el("h2", { id: "log-title" }, "Events"), this.count),
      el("div", { class: "log-frame", tabindex: "0", role: "region", "aria-label": "events, newest first" },
        this.empty, this.list));
  }

  /** Switch to another run, or to none. */
  async show(place) {
    this.place = place;
    this.events = [];
    this.known.clear();
    this.list.replaceChildren();
    this.tell();
    await this.reload();
  }

  /** Load all events of the run; repeated after some were missed. */
  async reload() {
    const { place } = this;
    if (!place) return;
    const { events } = await api(`${place}/log`).catch(() => ({ events: [] }));
    if (place !== this.place) return;
    const missed = events.filter((event) => !this.known.has(nameOf(event)));
    if (!missed.length) return;
    for (const event of missed) this.known.add(nameOf(event));
    this.events = [...this.events, ...missed].sort((one, other) => one.time_s - other.time_s).slice(-MOST);
    this.list.replaceChildren(...this.events.map((event) => this.row(event)).reverse());
    this.tell();
  }

  add(event) {
    if (this.known.has(nameOf(event))) return;
    this.known.add(nameOf(event));
    this.events.push(event);
    this.list.prepend(this.row(event));
    if (this.events.length > MOST) { this.events.shift(); this.list.lastChild.remove(); }
    this.tell();
    this.fresh.push(event);
    this.timer ??= setTimeout(() => this.say(), APART_MS);
  }

  row(event) {
    return el("li", { "data-kind": event.kind },
      el("span", { class: "time" }, `${fixed(event.time_s, 2)} s`),
      el("span", { class: `badge ${TONES[event.kind] ?? "soft"}` }, event.kind),
      el("span", { class: "text" }, event.text));
  }

  tell() {
    this.empty.hidden = this.events.length > 0;
    this.count.textContent = this.events.length ? `${this.events.length}, newest first` : "";
    this.changed(this.events);
  }

  /** Announce all new events at once. */
  say() {
    const last = this.fresh.at(-1), count = this.fresh.length;
    this.fresh = [];
    this.timer = null;
    if (last) announce(`${count > 1 ? `${count} events, the last: ` : ""}${last.kind}: ${last.text}`);
  }
}

// The floor of a live shop: machines by stage with their states, and buffers between them.

import { counted, el, fill, fixed, number } from "/dashboard/app.js";
import { COLOURS, DOWN, span } from "/dashboard/factory_states.js";

/** most batches of a buffer that are drawn one by one */
const MOST_DRAWN = 12;

/** Floor in an element; `fail(name)` is called by the button of a machine. */
export class Floor {
  constructor(place, fail) {
    this.place = place;
    this.fail = fail;
    this.machines = new Map();
    this.buffers = new Map();
    this.ends = {};
  }

  /** Show a status; `mayFail` whether machines can be made to fail. */
  show(status, mayFail) {
    if (!this.machines.size) this.build(status);
    for (const machine of status.machines) this.showMachine(machine, status.time_s, mayFail);
    for (const buffer of status.buffers) this.showBuffer(buffer);
    const endless = status.products.every(({ waiting }) => waiting === null);
    const waiting = status.products.reduce((sum, { waiting: own }) => sum + (own ?? 0), 0);
    this.ends.raw.textContent = endless ? "never runs out" : `${waiting} ${waiting === 1 ? "batch" : "batches"}`;
    this.ends.good.textContent = `${status.line.good} good`;
    this.ends.lost.textContent = `${status.line.lost} scrapped`;
  }

  build(status) {
    const stages = Math.max(...status.machines.map(({ stage }) => stage ?? 0)) + 1;
    this.ends = { raw: el("b"), good: el("b", { id: "floor-good" }), lost: el("span", { class: "soft" }) };
    const row = [el("div", { class: "store" }, el("h3", {}, "Raw stock"), this.ends.raw)];
    for (let stage = 0; stage < stages; stage += 1) {
      const own = status.machines.filter((machine) => (machine.stage ?? 0) === stage);
      row.push(el("div", { class: "stage", role: "list", "aria-label": `stage ${stage + 1}` },
        own.map((machine) => this.makeMachine(machine))));
      const behind = status.buffers.filter((buffer) => (buffer.stage ?? 0) === stage);
      if (behind.length) row.push(el("div", { class: "between" }, behind.map((buffer) => this.makeBuffer(buffer))));
    }
    row.push(el("div", { class: "store" }, el("h3", {}, "Finished"), this.ends.good, this.ends.lost));
    fill(this.place, row);
  }

  makeMachine({ name }) {
    const parts = { state: el("b", { class: "state-name" }), since: el("span", { class: "soft" }),
      swatch: el("i", { class: "state-colour" }), work: el("div", { class: "work" }),
      program: el("div", { class: "soft small" }), bar: el("progress", { max: "1", "aria-label": `part on ${name}` }),
      power: el("span", {}), made: el("span", {}),
      fail: el("button", { class: "small", "data-fail": name, onclick: () => this.fail(name) }, "Fail…") };
    parts.box = el("div", { class: "machine", role: "listitem", "data-machine": name },
      el("div", { class: "machine-head" }, el("h3", {}, name), parts.fail),
      el("div", { class: "machine-state" }, parts.swatch, parts.state, parts.since),
      parts.work, parts.program, parts.bar,
      el("div", { class: "machine-foot" }, parts.power, parts.made));
    this.machines.set(name, parts);
    return parts.box;
  }

  showMachine(machine, now, mayFail) {
    const parts = this.machines.get(machine.name);
    const text = (place, words) => { if (place.textContent !== words) place.textContent = words; };
    if (parts.box.dataset.state !== machine.state) {
      parts.box.dataset.state = machine.state;
      parts.box.style.setProperty("--state", COLOURS[machine.state]);
      text(parts.state, machine.state);
    }
    text(parts.since, `for ${span(now - machine.since_s)}`);
    const part = machine.part === null ? "" : ` · part ${machine.batch}-${machine.part}`;
    text(parts.work, machine.batch === null ? "no batch" : `${machine.product} · batch ${machine.batch}${part}`);
    text(parts.program, machine.program ?? "");
    if (machine.progress === null) parts.bar.value = 0;
    else parts.bar.value = machine.progress;
    text(parts.power, `${fixed(machine.power_kw, 2)} kW · ${number(machine.energy_kwh, 3)} kWh`);
    text(parts.made, counted(machine.parts, "part"));
    const isDown = DOWN.includes(machine.state);
    parts.fail.hidden = !mayFail;
    parts.fail.disabled = isDown;
  }

  makeBuffer({ name, capacity }) {
    const parts = { level: el("b"), rack: el("div", { class: "rack", "aria-hidden": "true" }),
      offered: el("span", { class: "small offered" }), capacity };
    this.buffers.set(name, parts);
    return el("div", { class: "buffer", "data-buffer": name }, el("h3", {}, name), parts.rack,
      el("div", {}, parts.level), parts.offered);
  }

  showBuffer({ name, level, offered, capacity }) {
    const parts = this.buffers.get(name), shown = `${level}/${offered}`;
    if (parts.shown === shown) return;
    parts.shown = shown;
    const places = Math.min(capacity ?? Math.max(level, 1), MOST_DRAWN);
    const used = capacity && capacity > MOST_DRAWN ? Math.round((level / capacity) * MOST_DRAWN) : level;
    fill(parts.rack, Array.from({ length: places }, (_, at) => el("i", { class: at < used ? "full" : "" })));
    const most = capacity === null ? "" : ` of ${capacity}`;
    parts.level.textContent = `${level}${most} ${(capacity ?? level) === 1 ? "batch" : "batches"}`;
    parts.offered.textContent = offered ? `${offered} waiting for room` : "";
  }
}

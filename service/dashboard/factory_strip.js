// States of machines over time, and below them power and stock, drawn on one time axis.

import { el, fill, fixed } from "/dashboard/app.js";
import { colour } from "/dashboard/charts.js";
import { COLOURS } from "/dashboard/factory_states.js";

const ROW = 22, CHART = 96, GAP = 26, AXIS = 26, TOP = 6, HOUR = 3600;

/** Return a round step of about a sixth of a range. */
function step(range, steps) {
  const rough = range / steps, power = 10 ** Math.floor(Math.log10(rough));
  return [1, 2, 5, 10].find((each) => each * power >= rough) * power;
}

/** Strips on a canvas; the texts beside it carry the same information. */
export class Strip {
  constructor(place) {
    this.canvas = el("canvas", { id: "strip", role: "img" });
    this.told = el("div", { class: "small soft strip-told", id: "strip-told" }, "Point at a bar to see state and time.");
    this.keys = el("ul", { class: "keys", "aria-label": "colours of states" });
    fill(place, this.keys, this.canvas, this.told);
    this.states = null;
    this.series = null;
    this.canvas.addEventListener("pointermove", (event) => this.point(event));
    new ResizeObserver(() => this.draw()).observe(place);
    document.addEventListener("theme", () => this.draw());
  }

  /** Draw states and series of a range of time. */
  show(states, series) {
    this.states = states;
    this.series = series;
    const seen = new Set(states.machines.flatMap(({ state }) => state));
    const shown = Object.keys(COLOURS).filter((name) => seen.has(name));
    if (this.shownKeys !== shown.join()) {
      this.shownKeys = shown.join();
      fill(this.keys, shown.map((name) => {
        const swatch = el("span", { class: "swatch" });
        swatch.style.background = COLOURS[name];
        return el("li", {}, swatch, name);
      }));
    }
    this.draw();
  }

  get left() { return Math.min(120, 18 + 7 * Math.max(6, ...(this.states?.machines ?? []).map(({ name }) => name.length))); }

  draw() {
    const { states, canvas } = this;
    const width = canvas.parentElement?.clientWidth ?? 0;
    if (!states || width < 50) return;
    const rows = states.machines.length, height = TOP + rows * ROW + 2 * (GAP + CHART) + AXIS;
    const scale = devicePixelRatio || 1;
    canvas.width = Math.round(width * scale);
    canvas.height = Math.round(height * scale);
    canvas.style.height = `${height}px`;
    const pen = canvas.getContext("2d");
    pen.setTransform(scale, 0, 0, scale, 0, 0);
    pen.clearRect(0, 0, width, height);
    pen.font = "12px system-ui, sans-serif";
    const { left } = this, right = width - 12, { begin_s: begin, end_s: end } = states;
    const long = Math.max(end - begin, 1);
    this.at = (x) => begin + ((x - left) / (right - left)) * long;
    const x = (time) => left + ((time - begin) / long) * (right - left);
    const ink = colour("ink"), rule = colour("rule"), soft = colour("soft");

    const ticks = step(long / HOUR, width < 500 ? 4 : 8) * HOUR;
    const bottom = height - AXIS;
    pen.strokeStyle = rule;
    pen.fillStyle = soft;
    pen.textAlign = "center";
    pen.textBaseline = "top";
    for (let at = Math.ceil(begin / ticks) * ticks; at <= end; at += ticks) {
      pen.beginPath();
      pen.moveTo(x(at), TOP);
      pen.lineTo(x(at), bottom);
      pen.stroke();
      pen.fillText(`${Number((at / HOUR).toPrecision(6))} h`, x(at), bottom + 4);
    }

    pen.textBaseline = "middle";
    states.machines.forEach((machine, row) => {
      const y = TOP + row * ROW;
      pen.fillStyle = ink;
      pen.textAlign = "right";
      pen.fillText(machine.name, left - 8, y + ROW / 2, left - 12);
      machine.state.forEach((state, at) => {
        const from = x(machine.begin_s[at]), to = x(machine.end_s[at]);
        pen.fillStyle = COLOURS[state];
        pen.fillRect(from, y + 2, Math.max(to - from, 0.6), ROW - 4);
      });
    });
    const places = TOP + rows * ROW + GAP;
    this.curve(pen, places, { name: "power_kw", title: "Power of the line, kW", tone: "curve-1" }, x, right);
    this.curve(pen, places + CHART + GAP, { name: "wip_parts", title: "Parts in the shop", tone: "curve-2" }, x, right);
    const last = states.machines.map(({ name, state }) => `${name} ${state.at(-1) ?? ""}`).join(", ");
    canvas.setAttribute("aria-label", `states of ${rows} machines over ${fixed(long / HOUR, 1)} h, now: ${last}`);
  }

  curve(pen, top, { name, title, tone }, x, right) {
    const signal = this.series?.signals[name], { left } = this;
    pen.fillStyle = colour("ink");
    pen.textAlign = "left";
    pen.textBaseline = "bottom";
    pen.fillText(title, left, top - 3);
    if (!signal?.mean.length) return;
    const times = this.series.begin_s, most = Math.max(...signal.high, 1e-6);
    const ticks = step(most, 3), y = (value) => top + CHART - (value / (1.08 * most)) * CHART;
    pen.strokeStyle = colour("rule");
    pen.fillStyle = colour("soft");
    pen.textAlign = "right";
    pen.textBaseline = "middle";
    for (let value = 0; value <= most; value += ticks) {
      pen.beginPath();
      pen.moveTo(left, y(value));
      pen.lineTo(right, y(value));
      pen.stroke();
      pen.fillText(String(Number(value.toPrecision(4))), left - 8, y(value));
    }
    // Each value is that of the time since the row before.
    const line = new Path2D();
    line.moveTo(x(times[0]), y(signal.mean[0]));
    signal.mean.forEach((value, at) => {
      line.lineTo(x(at ? this.series.end_s[at - 1] : times[0]), y(value));
      line.lineTo(x(this.series.end_s[at]), y(value));
    });
    pen.save();
    pen.beginPath();
    pen.rect(left, top - 1, right - left, CHART + 2);
    pen.clip();
    pen.strokeStyle = colour(tone);
    pen.lineWidth = 1.4;
    pen.stroke(line);
    line.lineTo(x(this.series.end_s.at(-1)), y(0));
    line.lineTo(x(times[0]), y(0));
    pen.globalAlpha = 0.16;
    pen.fillStyle = colour(tone);
    pen.fill(line);
    pen.restore();
  }

  point(event) {
    if (!this.states || !this.at) return;
    const box = this.canvas.getBoundingClientRect();
    const row = Math.floor((event.clientY - box.top - TOP) / ROW), time = this.at(event.clientX - box.left);
    const machine = this.states.machines[row];
    if (!machine) return;
    const at = machine.begin_s.findIndex((begin, each) => begin <= time && time < machine.end_s[each]);
    if (at < 0) return;
    const [begin, end] = [machine.begin_s[at], machine.end_s[at]];
    this.told.textContent = `${machine.name}: ${machine.state[at]}, ${fixed(begin / HOUR, 2)} h to ` +
      `${fixed(end / HOUR, 2)} h (${fixed((end - begin) / 60, 1)} min)`;
  }
}

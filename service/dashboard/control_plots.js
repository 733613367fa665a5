// Live plots of a run: feed rate, cutting force and removal rate over time.
//
// They are drawn directly on canvases: plotly.js, used by the other pages, takes 80 ms for three
// panels that grow ten times a second (measured: four frames in ten above 50 ms), this a few ms.

import { el, fixed, number } from "/dashboard/app.js";
import { colour } from "/dashboard/charts.js";
import { LEFT, RIGHT, drawGrid, drawLine, drawMarkers, stepOf } from "/dashboard/control_pen.js";
import { Rows } from "/dashboard/control_series.js";

const FOOT = 20, RELOAD_MS = 4000;

const PANELS = [
  // Rapids are cut off, because cutting feeds would not be readable beside them.
  { id: "feed", title: "Feed rate", unit: "mm/min", scale: ["programmed", "advised"], lines: [
    { name: "programmed", label: "programmed", colour: "curve-7", dash: [6, 4] },
    { name: "advised", label: "advised", colour: "curve-2" },
    { name: "actual", label: "actual", colour: "curve-1", width: 2.2 }] },
  { id: "force", title: "Cutting force", unit: "N", lines: [
    { name: "set_point", label: "set point", colour: "curve-2", dash: [6, 4] },
    { name: "expected", label: "expected", colour: "curve-3" },
    { name: "measured", label: "measured", colour: "curve-1", width: 2.2 }] },
  { id: "removal", title: "Removal rate", unit: "cm³/min", lines: [
    { name: "removal", label: "removed", colour: "curve-1", width: 2.2 }] },
];
const WINDOWS = [["10", 10, "10 s"], ["60", 60, "60 s"], ["all", null, "all"]];

const isLevel = (point, value) => Math.abs(point.low - value) <= 2e-4 * Math.abs(value)
  && Math.abs(point.high - value) <= 2e-4 * Math.abs(value);

export class Plots {
  constructor() {
    this.rows = null;
    this.events = [];
    this.window = 60;
    this.range = null;
    this.cursor = null;
    this.drag = null;
    this.isDirty = false;
    this.reloaded = 0;
    this.colours = {};
    this.node = this.build();
    new ResizeObserver(() => this.dirty()).observe(this.node);
    document.addEventListener("theme", () => { this.colours = {}; this.dirty(); });
  }

  build() {
    this.windows = WINDOWS.map(([id, seconds, text]) => el("button", { type: "button",
      id: `window-${id}`, "aria-pressed": String(seconds === this.window),
      onclick: () => this.slide(seconds) }, text));
    this.back = el("button", { type: "button", id: "plots-live", hidden: true,
      onclick: () => this.slide(this.window) }, "Back to live");
    this.under = el("span", { class: "soft small", id: "plots-at" }, "");
    this.panels = PANELS.map((panel, row) => this.panel(panel, row === PANELS.length - 1));
    const frame = el("div", { class: "strips", tabindex: "0", role: "group", id: "plots-frame",
      "aria-label": "Plots over time: arrow keys move, plus and minus zoom, Home returns to live",
      onkeydown: (event) => this.key(event) }, this.panels.map((panel) => panel.node));
    return el("section", { class: "card plots", id: "plots", "aria-labelledby": "plots-title" },
      el("div", { class: "row spread" }, el("h2", { id: "plots-title" }, "Plots"), this.under,
        el("div", { class: "row" }, this.back, el("div", { class: "switch small", role: "group",
          "aria-label": "time range shown" }, this.windows))), frame);
  }

  panel(panel, isLast) {
    const canvas = el("canvas", { id: `plot-${panel.id}`, role: "img", class: isLast ? "last" : "",
      "aria-label": `${panel.title}, ${panel.unit}, over time in s` });
    const keys = panel.lines.map((line) => {
      const value = el("b", {}, "–");
      const swatch = el("i", { class: line.dash ? "dashed" : "", style: `color: var(--${line.colour})` });
      return { value, node: el("span", { class: "key" }, swatch, line.label, value) };
    });
    canvas.addEventListener("pointermove", (event) => this.move(event, canvas));
    canvas.addEventListener("pointerleave", () => { this.cursor = null; this.dirty(); });
    canvas.addEventListener("pointerdown", (event) => this.press(event, canvas));
    canvas.addEventListener("pointerup", (event) => this.release(event, canvas));
    canvas.addEventListener("pointercancel", () => { this.drag = null; this.dirty(); });
    canvas.addEventListener("dblclick", () => this.slide(this.window));
    const node = el("div", { class: "strip" }, el("div", { class: "keys" },
      el("span", { class: "name" }, panel.title, el("span", { class: "unit" }, panel.unit)),
      keys.map((key) => key.node)), canvas);
    return { ...panel, canvas, keys, node, isLast };
  }

  // -- display ----------------------------------------------------------------------------------

  /** Switch to another run, or to none; `hasRows`: the run has begun. */
  async show(place, hasRows) {
    this.rows = place ? new Rows(place, () => this.dirty()) : null;
    this.events = [];
    this.range = null;
    this.isRead = false;
    this.back.hidden = true;
    this.dirty();
    if (hasRows) await this.reload();
  }

  /** Follow the latest rows again; `seconds` null: show all of them. */
  slide(seconds) {
    this.window = seconds;
    this.windows.forEach((button, at) =>
      button.setAttribute("aria-pressed", String(WINDOWS[at][1] === seconds)));
    this.range = null;
    this.back.hidden = true;
    this.dirty();
    this.reload();
  }

  zoom(begin, end) {
    const last = this.rows?.last ?? 0, size = Math.max(end - begin, 0.2);
    const first = Math.max(0, Math.min(begin, last - 0.1));
    this.range = [first, first + size];
    this.back.hidden = false;
    this.dirty();
    clearTimeout(this.soon);
    this.soon = setTimeout(() => this.reload(), 120);
  }

  /** Read the displayed range from the service. */
  async reload() {
    if (!this.rows) return;
    this.reloaded = performance.now();
    this.isRead = true;
    const last = this.rows.last;
    const [begin, end] = this.range
      ?? [this.window === null || last === null ? null : last - this.window, null];
    await this.rows.load(begin, end).catch(() => {});
  }

  add(rows) {
    if (!this.rows) return;
    const isMuch = this.rows.add(rows);
    const wants = !this.isRead || isMuch || (this.rows.isThinned && !this.range);
    if (wants && (!this.isRead || performance.now() - this.reloaded > RELOAD_MS)) this.reload();
  }

  mark(events) {
    this.events = events;
    this.dirty();
  }

  get shown() {
    if (this.range) return this.range;
    const last = this.rows?.last ?? 0;
    if (this.window === null) return [0, Math.max(last, 10)];
    return [Math.max(0, last - this.window), Math.max(last, this.window)];
  }

  // -- interaction ------------------------------------------------------------------------------

  timeAt(event, canvas) {
    const box = canvas.getBoundingClientRect(), [begin, end] = this.shown;
    const share = (event.clientX - box.left - LEFT) / (box.width - LEFT - RIGHT);
    return begin + Math.min(Math.max(share, 0), 1) * (end - begin);
  }
  move(event, canvas) {
    this.cursor = this.timeAt(event, canvas);
    if (this.drag) this.drag.to = this.cursor;
    this.dirty();
  }
  press(event, canvas) {
    canvas.setPointerCapture(event.pointerId);
    const from = this.timeAt(event, canvas);
    this.drag = { from, to: from, x: event.clientX };
  }
  release(event) {
    const drag = this.drag;
    this.drag = null;
    if (drag && Math.abs(event.clientX - drag.x) > 8) {
      this.zoom(Math.min(drag.from, drag.to), Math.max(drag.from, drag.to));
    }
    this.dirty();
  }
  key(event) {
    const [begin, end] = this.shown, size = end - begin, middle = 0.5 * (begin + end);
    const move = { ArrowLeft: [begin - 0.25 * size, end - 0.25 * size],
      ArrowRight: [begin + 0.25 * size, end + 0.25 * size],
      "+": [middle - 0.25 * size, middle + 0.25 * size],
      "-": [middle - size, middle + size] }[event.key];
    if (event.key === "Home" || event.key === "Escape") this.slide(this.window);
    else if (move) this.zoom(...move);
    else return;
    event.preventDefault();
  }

  // -- drawing ----------------------------------------------------------------------------------

  dirty() {
    if (this.isDirty) return;
    this.isDirty = true;
    requestAnimationFrame(() => { this.isDirty = false; this.draw(); });
  }

  ink(name) { return (this.colours[name] ??= colour(name)); }

  draw() {
    const [begin, end] = this.shown, moment = this.cursor ?? this.rows?.last;
    for (const panel of this.panels) this.drawPanel(panel, begin, end);
    this.panels.forEach((panel) => panel.lines.forEach((line, at) => {
      const value = this.rows && moment !== null ? this.rows.at(line.name, moment) : null;
      const text = value === null ? "–" : fixed(value, value < 10 ? 1 : 0);
      if (panel.keys[at].value.textContent !== text) panel.keys[at].value.textContent = text;
    }));
    this.tellUnder(begin, end);
  }

  tellUnder(begin, end) {
    let text = "";
    if (this.cursor !== null) {
      const near = (end - begin) * 0.012;
      const events = this.events.filter((each) => Math.abs(each.time_s - this.cursor) < near);
      text = [`at ${fixed(this.cursor, 2)} s`, ...events.slice(0, 2).map((each) => each.text)].join(" · ");
    } else if (this.range) text = `${number(begin, 4)} to ${number(end, 4)} s`;
    if (this.under.textContent !== text) this.under.textContent = text;
  }

  drawPanel(panel, begin, end) {
    const { canvas } = panel, ratio = window.devicePixelRatio || 1;
    const width = canvas.clientWidth, height = canvas.clientHeight;
    if (!width || !height) return;
    if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
      canvas.width = Math.round(width * ratio);
      canvas.height = Math.round(height * ratio);
    }
    const pen = canvas.getContext("2d"), ink = (name) => this.ink(name);
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, width, height);
    const foot = panel.isLast ? FOOT : 5, top = 5;
    const x = (time) => LEFT + ((time - begin) / (end - begin)) * (width - LEFT - RIGHT);
    const drawn = panel.lines.map((line) => this.columns(line.name, begin, end, x));
    const scaling = drawn.filter((_, at) => panel.scale?.includes(panel.lines[at].name) ?? true);
    const most = Math.max(...scaling.map((each) => each.most), 0)
      || Math.max(...drawn.map((each) => each.most), 0) || 1;
    const step = stepOf(most * 1.04, 3), high = Math.ceil((most * 1.04) / step) * step;
    const y = (value) => height - foot - (Math.max(value, 0) / high) * (height - foot - top);
    pen.font = "11px system-ui, sans-serif";
    drawGrid(pen, ink, { x, y, begin, end, step, high, width, height, foot, top, isLast: panel.isLast,
      hasData: drawn.some((each) => each.runs.length) });
    pen.save();
    pen.beginPath();
    pen.rect(LEFT, 0, width - LEFT - RIGHT, height - foot + 1);
    pen.clip();
    drawMarkers(pen, ink, this.events, { x, begin, end, height, foot, hasWords: panel === this.panels[0] });
    panel.lines.forEach((line, at) => drawLine(pen, ink(line.colour), drawn[at].runs, y, line));
    this.hands(pen, x, height, foot);
    pen.restore();
  }

  /** Draw a line as minimum and maximum of each pixel column, so that no peak is lost. */
  columns(name, begin, end, x) {
    const runs = [];
    let run = null, most = 0;
    this.rows?.points(name, begin, end, (time, low, high) => {
      if (low === null || high === null) { run = null; return; }
      const at = x(time), column = Math.round(at);
      if (time >= begin && time <= end) most = Math.max(most, high);
      const last = run?.at(-1), before = run?.at(-2);
      // Level pieces are drawn as one stroke, because dashes along many points are slow.
      if (before && low === high && isLevel(before, low) && isLevel(last, low)) {
        Object.assign(last, { column, x: at, isEnd: true });
        return;
      }
      if (last?.column === column && !last.isEnd) {
        last.low = Math.min(last.low, low);
        last.high = Math.max(last.high, high);
        return;
      }
      if (!run) runs.push(run = []);
      run.push({ column, x: at, low, high });
    });
    return { runs, most };
  }

  hands(pen, x, height, foot) {
    if (this.drag && Math.abs(this.drag.to - this.drag.from) > 0) {
      pen.fillStyle = this.ink("accent");
      pen.globalAlpha = 0.18;
      pen.fillRect(x(this.drag.from), 0, x(this.drag.to) - x(this.drag.from), height - foot);
      pen.globalAlpha = 1;
    }
    if (this.cursor === null) return;
    pen.strokeStyle = this.ink("soft");
    pen.lineWidth = 1;
    pen.beginPath();
    pen.moveTo(x(this.cursor), 0);
    pen.lineTo(x(this.cursor), height - foot);
    pen.stroke();
  }
}

// Plane view of lines and dots on a canvas: thousands of coloured strands, without WebGL.
// (plotly's scattergl needs functions compiled from strings, which the page's policy forbids, and
// its SVG lines need an element for each strand.) Wheel, drag, buttons and keys zoom and move.

import { el, fill, number } from "/dashboard/app.js";
import { colour } from "/dashboard/charts.js";

const EDGE = { left: 52, right: 12, top: 10, bottom: 40 };
const BAR = 74;

/** Plane view in an element of the page. Running state. */
export class FlatView {
  constructor(place) {
    this.canvas = el("canvas", { tabindex: "0", role: "img" });
    this.told = el("div", { class: "told-at small", hidden: true });
    const button = (name, label, action) => el("button", { type: "button", "aria-label": label, title: label,
      onclick: action }, name);
    fill(place, this.canvas, this.told, el("div", { class: "zoom no-print" }, button("+", "zoom in", () => this.zoom(1.5)),
      button("−", "zoom out", () => this.zoom(1 / 1.5)), button("⤢", "whole path", () => this.whole())));
    this.place = place;
    this.scene = null;
    /** Whether all is shown, as after the first drawing; then it follows the size of the window. */
    this.isWhole = true;
    this.bind();
  }

  /**
   * Show strands: `lines` = [{at, colour, width, dash}] with `at` as indices of points, -1 for a gap; `dots` =
   * [{at, colour, size, least}] are squares of a size in mm, and of at least so many pixels; `mark` = [x, y] is
   * ringed; `x`, `y` in mm; `titles` of the axes; `bar` = {title, low, high, colours} or null; `tell(at)` describes a point.
   */
  show(scene) {
    scene.lines ??= [];
    scene.dots ??= [];
    const isOther = this.scene?.key !== scene.key;
    this.scene = scene;
    this.canvas.setAttribute("aria-label", scene.label);
    if (isOther) this.whole(); else this.draw();
  }

  whole() {
    this.isWhole = true;
    const [left, right] = extent(this.scene.x), [low, high] = extent(this.scene.y);
    this.measure();
    this.middle = [(left + right) / 2, (low + high) / 2];
    this.scale = 0.94 * Math.min(this.wide / Math.max(right - left, 1e-3), this.tall / Math.max(high - low, 1e-3));
    this.draw();
  }

  measure() {
    const { clientWidth, clientHeight } = this.place;
    [this.width, this.height] = [clientWidth, clientHeight];
    this.wide = Math.max(clientWidth - EDGE.left - EDGE.right - (this.scene.bar ? BAR : 0), 40);
    this.tall = Math.max(clientHeight - EDGE.top - EDGE.bottom, 40);
  }

  /** Return the pixel coordinates of a point. */
  at(x, y) {
    return [EDGE.left + this.wide / 2 + (x - this.middle[0]) * this.scale,
      EDGE.top + this.tall / 2 - (y - this.middle[1]) * this.scale];
  }

  zoom(by, across = EDGE.left + this.wide / 2, down = EDGE.top + this.tall / 2) {
    const dx = (across - EDGE.left - this.wide / 2) / this.scale, dy = (EDGE.top + this.tall / 2 - down) / this.scale;
    this.middle = [this.middle[0] + dx * (1 - 1 / by), this.middle[1] + dy * (1 - 1 / by)];
    this.scale *= by;
    this.isWhole = false;
    this.draw();
  }

  move(across, down) {
    this.middle = [this.middle[0] - across / this.scale, this.middle[1] + down / this.scale];
    this.isWhole = false;
    this.draw();
  }

  draw() {
    if (!this.scene || this.place.hidden) return;
    this.measure();
    const sharp = window.devicePixelRatio || 1, pen = this.canvas.getContext("2d");
    this.canvas.width = this.width * sharp;
    this.canvas.height = this.height * sharp;
    pen.setTransform(sharp, 0, 0, sharp, 0, 0);
    pen.font = "12px system-ui, sans-serif";
    this.axes(pen);
    pen.save();
    pen.beginPath();
    pen.rect(EDGE.left, EDGE.top, this.wide, this.tall);
    pen.clip();
    pen.lineJoin = "round";
    const { x, y } = this.scene;
    for (const line of this.scene.lines) {
      pen.strokeStyle = line.colour;
      pen.lineWidth = line.width;
      pen.setLineDash(line.dash ?? []);
      pen.beginPath();
      let isDown = false;
      for (const at of line.at) {
        if (at < 0) { isDown = false; continue; }
        const [across, down] = this.at(x[at], y[at]);
        if (isDown) pen.lineTo(across, down); else pen.moveTo(across, down);
        isDown = true;
      }
      pen.stroke();
    }
    for (const dot of this.scene.dots) {
      const size = Math.max(dot.size * this.scale, dot.least);
      pen.fillStyle = dot.colour;
      for (const at of dot.at) {
        const [across, down] = this.at(x[at], y[at]);
        pen.fillRect(across - size / 2, down - size / 2, size, size);
      }
    }
    if (this.scene.mark) this.mark(pen, ...this.at(...this.scene.mark));
    pen.restore();
    if (this.scene.bar) this.bar(pen);
  }

  axes(pen) {
    const right = EDGE.left + this.wide, bottom = EDGE.top + this.tall, step = roundStep(70 / this.scale);
    const [left, low] = [this.middle[0] - this.wide / 2 / this.scale, this.middle[1] - this.tall / 2 / this.scale];
    pen.strokeStyle = colour("rule");
    pen.fillStyle = colour("ink");
    pen.lineWidth = 1;
    pen.textAlign = "center";
    for (let value = Math.ceil(left / step) * step; value <= left + this.wide / this.scale; value += step) {
      const [across] = this.at(value, 0);
      stroke(pen, across, EDGE.top, across, bottom);
      pen.fillText(number(near(value, step)), across, bottom + 15);
    }
    pen.textAlign = "right";
    for (let value = Math.ceil(low / step) * step; value <= low + this.tall / this.scale; value += step) {
      const [, down] = this.at(0, value);
      stroke(pen, EDGE.left, down, right, down);
      pen.fillText(number(near(value, step)), EDGE.left - 6, down + 4);
    }
    pen.textAlign = "center";
    pen.fillText(this.scene.titles[0], EDGE.left + this.wide / 2, bottom + 33);
    upright(pen, this.scene.titles[1], 12, EDGE.top + this.tall / 2);
  }

  /** Draw a ring that stands out on any colour. */
  mark(pen, across, down) {
    pen.setLineDash([]);
    for (const [name, width] of [["card", 6], ["ink", 2.5]]) {
      pen.strokeStyle = colour(name);
      pen.lineWidth = width;
      pen.beginPath();
      pen.arc(across, down, 11, 0, 2 * Math.PI);
      pen.stroke();
    }
  }

  /** Move to a point, unless it is in sight. */
  reveal(x, y) {
    const [across, down] = this.at(x, y);
    const isSeen = across > EDGE.left && across < EDGE.left + this.wide && down > EDGE.top && down < EDGE.top + this.tall;
    if (!isSeen) [this.middle, this.isWhole] = [[x, y], false];
    this.draw();
  }

  bar(pen) {
    const { title, low = 0, high, colours } = this.scene.bar, left = EDGE.left + this.wide + 14, { tall } = this;
    colours.forEach((name, at) => {
      pen.fillStyle = name;
      pen.fillRect(left, EDGE.top + tall * (1 - (at + 1) / colours.length), 12, tall / colours.length + 1);
    });
    pen.fillStyle = colour("ink");
    pen.textAlign = "left";
    const step = roundStep((high - low) / 5);
    for (let value = Math.ceil(low / step) * step; value <= high * 1.0001; value += step)
      pen.fillText(number(near(value, step)), left + 16,
        EDGE.top + tall * (1 - (value - low) / (high - low)) + (value > low ? 4 : 0));
    upright(pen, title, this.width - 8, EDGE.top + tall / 2);
  }

  /** Return the point of a coloured line nearest to a position, if near enough. */
  nearest(across, down) {
    let found = -1, least = 14 ** 2;
    for (const line of this.scene.lines) {
      if (line.isQuiet) continue;
      for (const at of line.at) {
        if (at < 0) continue;
        const [x, y] = this.at(this.scene.x[at], this.scene.y[at]), far = (x - across) ** 2 + (y - down) ** 2;
        if (far < least) { least = far; found = at; }
      }
    }
    // The dots that are drawn last lie on top.
    for (const dot of this.scene.dots.toReversed()) {
      if (found >= 0 && least <= 4 ** 2) break;
      for (const at of dot.at) {
        const [x, y] = this.at(this.scene.x[at], this.scene.y[at]), far = (x - across) ** 2 + (y - down) ** 2;
        if (far < least) { least = far; found = at; }
      }
    }
    return found;
  }

  bind() {
    let from = null;
    const { canvas } = this;
    canvas.addEventListener("wheel", (event) => {
      // Without Ctrl the wheel scrolls the page, unless the view has the focus.
      if (!event.ctrlKey && document.activeElement !== canvas) return;
      event.preventDefault();
      this.zoom(event.deltaY < 0 ? 1.2 : 1 / 1.2, event.offsetX, event.offsetY);
    }, { passive: false });
    canvas.addEventListener("pointerdown", (event) => {
      if (event.pointerType === "touch") return;
      from = [event.clientX, event.clientY];
      canvas.setPointerCapture(event.pointerId);
    });
    canvas.addEventListener("pointermove", (event) => {
      if (from) {
        this.move(event.clientX - from[0], event.clientY - from[1]);
        from = [event.clientX, event.clientY];
      } else this.tell(event.offsetX, event.offsetY);
    });
    for (const name of ["pointerup", "pointercancel"]) canvas.addEventListener(name, () => { from = null; });
    canvas.addEventListener("pointerleave", () => { this.told.hidden = true; });
    canvas.addEventListener("click", (event) => this.tell(event.offsetX, event.offsetY));
    canvas.addEventListener("dblclick", () => this.whole());
    canvas.addEventListener("keydown", (event) => {
      const steps = { ArrowLeft: [40, 0], ArrowRight: [-40, 0], ArrowUp: [0, 40], ArrowDown: [0, -40] }[event.key];
      if (steps) this.move(...steps);
      else if (event.key === "+" || event.key === "=") this.zoom(1.5);
      else if (event.key === "-") this.zoom(1 / 1.5);
      else if (event.key === "0") this.whole();
      else return;
      event.preventDefault();
    });
    document.addEventListener("theme", () => this.scene?.again());
    new ResizeObserver(() => (this.isWhole && this.scene && !this.place.hidden ? this.whole() : this.draw())).observe(this.place);
  }

  tell(across, down) {
    const at = this.nearest(across, down);
    this.told.hidden = at < 0;
    if (at < 0) return;
    fill(this.told, this.scene.tell(at).map((text) => el("div", {}, text)));
    const isRight = across > this.width / 2;
    this.told.style.left = isRight ? "auto" : `${across + 14}px`;
    this.told.style.right = isRight ? `${this.width - across + 14}px` : "auto";
    this.told.style.top = `${Math.max(down - 20, 0)}px`;
  }
}

function extent(values) {
  let low = Infinity, high = -Infinity;
  for (const value of values) { low = Math.min(low, value); high = Math.max(high, value); }
  return [low, high];
}

/** Return the next 1, 2 or 5 times a power of ten that is not below a value. */
function roundStep(least) {
  const power = 10 ** Math.floor(Math.log10(least));
  return [1, 2, 5, 10].find((factor) => factor * power >= least * 0.999) * power;
}

const near = (value, step) => Math.round(value / step) * step || 0;

function stroke(pen, x1, y1, x2, y2) {
  pen.beginPath();
  pen.moveTo(Math.round(x1) + 0.5, Math.round(y1) + 0.5);
  pen.lineTo(Math.round(x2) + 0.5, Math.round(y2) + 0.5);
  pen.stroke();
}

function upright(pen, text, x, y) {
  pen.save();
  pen.translate(x, y);
  pen.rotate(-Math.PI / 2);
  pen.textAlign = "center";
  pen.fillText(text, 0, 0);
  pen.restore();
}

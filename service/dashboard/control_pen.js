// Drawing of plots on a canvas: grids, lines and marks.

import { number } from "/dashboard/app.js";

/** margins beside the plots, in px */
export const LEFT = 52, RIGHT = 10;

/** colours of event kinds, by their names in app.css */
export const TONES = { over: "bad", stop: "bad", breakage: "bad", lost: "bad", refused: "bad", hold: "warn",
  warning: "warn", wear: "warn", hardness: "warn", unreachable: "warn", silence: "warn",
  "not followed": "bad", averaged: "warn", followed: "good",
  safe: "good", resume: "good" };

/** Return a round step that divides `top` into about a number of parts. */
export function stepOf(top, count) {
  const rough = top / count, power = 10 ** Math.floor(Math.log10(rough));
  return power * [1, 2, 2.5, 5, 10].find((each) => each * power >= rough * 0.999);
}

/** Draw a line through runs of columns. */
export function drawLine(pen, ink, runs, y, line) {
  pen.strokeStyle = ink;
  pen.lineWidth = line.width ?? 1.4;
  pen.lineJoin = "bevel";
  pen.setLineDash(line.dash ?? []);
  pen.beginPath();
  for (const run of runs) {
    run.forEach((point, at) => {
      if (at === 0) pen.moveTo(point.x, y(point.low)); else pen.lineTo(point.x, y(point.low));
      if (point.high > point.low) pen.lineTo(point.x, y(point.high));
    });
  }
  pen.stroke();
  pen.setLineDash([]);
}

/** Draw axes with their numbers. */
export function drawGrid(pen, ink, { x, y, begin, end, step, high, width, height, foot, top, isLast, hasData }) {
  pen.strokeStyle = ink("rule");
  pen.fillStyle = ink("soft");
  pen.lineWidth = 1;
  pen.textBaseline = "middle";
  pen.textAlign = "right";
  pen.beginPath();
  for (let value = 0; value <= high * 1.001; value += step) {
    const at = Math.round(y(value)) + 0.5;
    pen.moveTo(LEFT, at);
    pen.lineTo(width - RIGHT, at);
    if (hasData || value === 0) pen.fillText(number(value, 3), LEFT - 6, Math.max(at, top + 2));
  }
  const apart = stepOf(end - begin, Math.max(2, Math.floor(width / 110)));
  pen.textAlign = "center";
  for (let time = Math.ceil(begin / apart) * apart; time <= end + 1e-9; time += apart) {
    const at = Math.round(x(time)) + 0.5;
    pen.moveTo(at, top);
    pen.lineTo(at, height - foot);
    if (!isLast || at > width - 40) continue;
    pen.fillText(number(time, time < 100 ? 3 : 5), at, height - foot + 11);
  }
  pen.stroke();
  if (!isLast) return;
  pen.textAlign = "right";
  pen.fillText("s", width - RIGHT, height - foot + 11);
}

/** Draw events as lines over the plots, with their kind where there is room. */
export function drawMarkers(pen, ink, events, { x, begin, end, height, foot, hasWords }) {
  let free = LEFT;
  pen.textAlign = "left";
  pen.textBaseline = "top";
  for (const event of events) {
    if (event.time_s < begin || event.time_s > end || event.kind === "workingstep") continue;
    const at = Math.round(x(event.time_s)) + 0.5;
    pen.strokeStyle = pen.fillStyle = ink(TONES[event.kind] ?? "accent");
    pen.globalAlpha = 0.75;
    pen.lineWidth = 1;
    pen.setLineDash([2, 3]);
    pen.beginPath();
    pen.moveTo(at, 0);
    pen.lineTo(at, height - foot);
    pen.stroke();
    pen.setLineDash([]);
    pen.globalAlpha = 1;
    if (!hasWords || at < free) continue;
    pen.fillText(event.kind, at + 3, 1);
    free = at + 8 + pen.measureText(event.kind).width;
  }
}

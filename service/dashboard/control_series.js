// Rows of a run for the plots: history by range from the service, then live rows.

import { api } from "/dashboard/app.js";

const POINTS = 1500, MOST_LIVE = 6000;

/** Lines of the plots: their signals, and how a value is computed from them. */
export const LINES = {
  programmed: { of: ["feed_programmed_mm_min"], make: (feed) => feed },
  advised: { of: ["feed_programmed_mm_min", "override_commanded_percent"],
    make: (feed, override) => 0.01 * feed * override },
  actual: { of: ["feed_actual_mm_min"], make: (feed) => feed },
  measured: { of: ["force_measured_n"], make: (force) => force },
  set_point: { of: ["force_set_point_n"], make: (force) => force },
  expected: { of: ["force_expected_n"], make: (force) => force },
  removal: { of: ["removal_rate_cm3_min"], make: (rate) => rate },
};
const SIGNALS = [...new Set(Object.values(LINES).flatMap((line) => line.of))];

/** Return the value of a line at an index of the columns; null if unknown. */
function made(line, read) {
  const values = line.of.map(read);
  return values.some((value) => value === null || value === undefined) ? null : line.make(...values);
}

/** Rows of one run. `place` is its path; `changed()` is called when there is something to draw. */
export class Rows {
  constructor(place, changed) {
    this.place = place;
    this.changed = changed;
    this.history = { begin: [], end: [] };
    this.live = { time: [], values: {} };
    this.isThinned = false;
    this.asked = 0;
    this.clear();
  }

  clear() {
    this.live = { time: [], values: Object.fromEntries(Object.keys(LINES).map((name) => [name, []])) };
  }

  /** Time of the last known row; null if there is none. */
  get last() { return this.live.time.at(-1) ?? this.history.end.at(-1) ?? null; }

  /** Read a range from the service; null: from the start, to the end. */
  async load(begin = null, end = null) {
    const turn = ++this.asked;
    const range = (begin === null ? "" : `&begin_s=${Math.max(begin, 0)}`) + (end === null ? "" : `&end_s=${end}`);
    const series = await api(`${this.place}/series?points=${POINTS}&signals=${SIGNALS}${range}`)
      .catch((error) => { if (error.status === 409) return null; throw error; });
    if (!series || turn !== this.asked) return;
    const history = { begin: series.begin_s, end: series.end_s };
    for (const [name, line] of Object.entries(LINES)) {
      history[name] = ["low", "high"].map((side) => series.begin_s.map((_, at) =>
        made(line, (signal) => series.signals[signal][side][at])));
    }
    this.history = history;
    if (end === null) {
      this.isThinned = false;
      const known = series.end_s.at(-1) ?? -1;
      const keep = this.live.time.findIndex((time) => time > known);
      this.cut(keep < 0 ? this.live.time.length : keep);
    }
    this.changed();
  }

  /** Add new rows; true if there are so many that the range should be read again. */
  add({ columns, is_reduced: isReduced }) {
    const from = this.live.time.at(-1) ?? -Infinity;
    columns.time_s.forEach((time, at) => {
      if (time <= from) return;
      this.live.time.push(time);
      for (const [name, line] of Object.entries(LINES)) {
        this.live.values[name].push(made(line, (signal) => columns[signal][at]));
      }
    });
    this.isThinned ||= isReduced;
    if (this.live.time.length > 2 * MOST_LIVE) this.cut(MOST_LIVE);
    this.changed();
    return this.live.time.length > MOST_LIVE;
  }

  cut(count) {
    this.live.time.splice(0, count);
    for (const values of Object.values(this.live.values)) values.splice(0, count);
  }

  /** Call `take(time, low, high)` for each point of a line in a time range, and for one beyond. */
  points(name, begin, end, take) {
    const { begin: times, end: ends, [name]: sides } = this.history;
    if (sides) {
      const [low, high] = sides, to = after(times, end);
      for (let at = Math.max(after(ends, begin) - 1, 0); at <= to && at < times.length; at += 1) {
        take(0.5 * (times[at] + ends[at]), low[at], high[at]);
      }
    }
    const { time, values: { [name]: values } } = this.live, known = ends.at(-1) ?? -Infinity;
    const to = after(time, end);
    for (let at = Math.max(after(time, Math.max(begin, known)) - (known < begin ? 1 : 0), 0);
      at <= to && at < time.length; at += 1) {
      if (time[at] > known) take(time[at], values[at], values[at]);
    }
  }

  /** Return the value of a line at a time, from the last row before it; null if unknown. */
  at(name, moment) {
    let found = null;
    this.points(name, moment, moment, (time, low, high) => {
      if (time <= moment + 1e-9 || found === null) found = high === null ? null : 0.5 * (low + high);
    });
    return found;
  }
}

/** Return the index of the first entry above a value in ascending numbers. */
function after(ascending, value) {
  let low = 0, high = ascending.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (ascending[middle] <= value) low = middle + 1; else high = middle;
  }
  return low;
}

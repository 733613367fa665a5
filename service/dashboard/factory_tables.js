// Tables of a shop: machines and processes while it runs, and the figures of its result.

import { el, fill, fixed, number } from "/dashboard/app.js";
import { framed } from "/dashboard/records.js";
import { COLOURS } from "/dashboard/factory_states.js";

const PRODUCTIVE = "machining";

const TITLES = { line: "Line", product: "Products", machine: "Machines", process: "Processes", buffer: "Buffers, mean" };

/** Create a table; the first column is a heading of its row, the others are right-aligned numbers. */
function table(id, heads, rows) {
  return el("table", { id }, el("thead", {}, el("tr", {},
    heads.map((head, at) => el("th", { scope: "col", class: at ? "n" : "" }, head)))),
  el("tbody", {}, rows.map((cells) => el("tr", {},
    cells.map((cell, at) => (at ? el("td", { class: "n" }, cell) : el("th", { scope: "row" }, cell)))))));
}

/** Bar of the shares of states in the time of a machine, with the shares as its label. */
function shares(seconds) {
  const whole = Object.values(seconds).reduce((sum, each) => sum + each, 0) || 1;
  const known = Object.keys(COLOURS).filter((state) => seconds[state] > 0);
  const label = known.map((state) => `${state} ${fixed((100 * seconds[state]) / whole, 0)} %`).join(", ");
  return el("div", { class: "shares", role: "img", "aria-label": label, title: label }, known.map((state) => {
    const part = el("i");
    part.style.background = COLOURS[state];
    part.style.width = `${(100 * seconds[state]) / whole}%`;
    return part;
  }));
}

/** Show tables of machines and processes of a live status. */
export function showLive(place, status) {
  const machines = status.machines.map((machine) => {
    const whole = Object.values(machine.seconds).reduce((sum, each) => sum + each, 0) || 1;
    return [machine.name, shares(machine.seconds), fixed((100 * (machine.seconds[PRODUCTIVE] ?? 0)) / whole, 1),
      String(machine.parts), String(machine.parts - machine.good), fixed(machine.power_kw, 2),
      number(machine.energy_kwh, 3)];
  });
  const processes = status.processes.map((each) => [
    `${each.product} step ${each.step} on ${each.machine}`, String(each.parts), fixed(each.machining_s, 1),
    fixed(each.energy_kj, 1), number(each.mean_kw, 3), number(each.peak_kw, 3), fixed(each.now_kw, 2)]);
  fill(place,
    el("section", { class: "card" }, el("h2", {}, "Energy and power by machine"), framed("machines",
      table("live-machines", ["machine", "time in states", "machining %", "parts", "scrapped", "now kW", "energy kWh"], machines))),
    el("section", { class: "card" }, el("h2", {}, "Energy and power by process"), processes.length
      ? framed("processes", table("live-processes",
        ["process", "parts", "machining s", "energy kJ a part", "mean kW", "peak kW", "now kW"], processes))
      : el("p", { class: "soft" }, "No part has been machined yet.")));
}

const cell = ({ mean, half_width: half }) => (mean === null ? "" : half === null ? number(mean, 4)
  : `${number(mean, 4)} ± ${number(half, 2)}`);

/** Create the tables of figures and of times in states of a result. */
export function resultTables(result) {
  const found = [];
  for (const [level, title] of Object.entries(TITLES)) {
    const own = result.measures.filter((each) => each.level === level);
    if (!own.length) continue;
    const quantities = [...new Set(own.map(({ quantity }) => quantity))];
    const names = [...new Set(own.map(({ name }) => name))];
    const rows = names.map((name) => [name || "all", ...quantities.map((quantity) => {
      const one = own.find((each) => each.name === name && each.quantity === quantity);
      return one ? cell(one) : "";
    })]);
    found.push(el("h3", {}, title), framed(title, table(`result-${level}`, [level, ...quantities], rows)));
  }
  const states = Object.keys(COLOURS).filter((state) => result.states.some((each) => each.state === state));
  const machines = [...new Set(result.states.map(({ machine }) => machine))];
  const hours = (machine, state) => result.states.find((each) => each.machine === machine && each.state === state)?.hours;
  const times = machines.map((machine) => [machine, ...states.map((state) => {
    const own = hours(machine, state);
    return own === undefined ? "" : number(own, 3);
  })]);
  found.push(el("h3", {}, "Hours in each state"), framed("states", table("result-states", ["machine", ...states], times)));
  return found;
}

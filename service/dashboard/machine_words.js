// Names of the enumerations in a run's rows, as in simulator/machine/samples.py.

export const EXECUTION = ["READY", "ACTIVE", "WAIT", "PROGRAM STOPPED", "PROGRAM COMPLETED"];
/** CSS classes of lamps, in the same order */
export const LAMPS = ["idle", "safe", "wait", "over", "idle"];

export const PATH_MODE = ["at rest", "RAPID", "FEED"];

/** conditions of the spindle drive */
export const CONDITION = ["NORMAL", "WARNING", "FAULT"];

/** Signal, key of the energy in a result, label, and colour in app.css of each component. */
export const COMPONENTS = [
  { signal: "base_power_w", energy: "base", label: "base load", colour: "curve-7" },
  { signal: "coolant_power_w", energy: "coolant", label: "coolant", colour: "curve-6" },
  { signal: "spindle_power_w", energy: "spindle", label: "spindle", colour: "curve-1" },
  { signal: "x_power_w", energy: "x_axis", label: "X axis", colour: "curve-2" },
  { signal: "y_power_w", energy: "y_axis", label: "Y axis", colour: "curve-3" },
  { signal: "z_power_w", energy: "z_axis", label: "Z axis", colour: "curve-4" },
];

/** Panels of the chart, see timePanels in charts.js. */
export const PANELS = [
  { title: "Power from the mains by component, W", unit: "W", isStacked: true,
    signals: COMPONENTS.map(({ signal, label, colour }) => ({ name: signal, label, colour })) },
  { title: "Feed, mm/min (rapids leave the frame)", unit: "mm/min",
    top: (greatest) => 1.35 * greatest("feed_programmed_mm_min"),
    signals: [
      { name: "feed_actual_mm_min", label: "actual", colour: "curve-1" },
      { name: "feed_programmed_mm_min", label: "commanded", colour: "curve-2", dash: "dash" },
    ] },
  { title: "Cutting force, N", unit: "N",
    signals: [{ name: "cutting_force_n", label: "cutting force", colour: "curve-3" }] },
];

export const PACES = [
  ["0", "as fast as possible"], ["1", "real time"], ["10", "10 ×"], ["100", "100 ×"],
];

export const paceWord = (pace) =>
  (PACES.find(([value]) => Number(value) === Number(pace)) ?? ["", `${pace} ×`])[1];

// States of machines: colours as in the report of a shop, and times of a shop in words.

/** colour of each state, as in extras/factory/figures.py; every colour stands beside its name */
export const COLOURS = {
  "machining": "#009E73",
  "batch set-up": "#0072B2",
  "part set-up": "#56B4E9",
  "part ejection": "#9ad0f5",
  "batch ejection": "#4a7fb0",
  "starved": "#d9d9d9",
  "blocked": "#E69F00",
  "waiting for crew": "#CC79A7",
  "failed": "#8b1a1a",
  "repair": "#D55E00",
  "maintenance": "#b59f00",
  "idling": "#e6e6e6",
  "off shift": "#8c8c8c",
};

/** states in which a machine cannot fail */
export const DOWN = ["failed", "repair", "maintenance", "off shift"];

const DAYS = ["Mon", "Tue", "Wed", "Thu", "Fri", "Sat", "Sun"], DAY = 86400;
const two = (count) => String(count).padStart(2, "0");

/** Return day and time of the week of a moment, s since Monday 0:00. */
export function weekTime(seconds) {
  const day = Math.floor(seconds / DAY), minutes = Math.floor((seconds % DAY) / 60);
  return `${DAYS[day % 7]} ${two(Math.floor(minutes / 60))}:${two(minutes % 60)}`;
}

/** Return a time in hours and minutes, or shorter ones in minutes and seconds. */
export function span(seconds) {
  if (seconds < 60) return `${Math.floor(seconds)} s`;
  if (seconds < 3600) return `${Math.floor(seconds / 60)} min ${two(Math.floor(seconds % 60))} s`;
  return `${Math.floor(seconds / 3600)} h ${two(Math.floor((seconds % 3600) / 60))} min`;
}

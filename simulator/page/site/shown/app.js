// Page: settings and touches become curves, a field, an answer of the localizer, and texts.

import { withPrefix } from "rcskin/charts";
import { Controls, element } from "rcskin/controls";
import { drawBelief, drawSkin, fit } from "rcskin/field";
import { Gestures } from "rcskin/gestures";
import { Skin } from "rcskin/skin";
import { SpectraCharts } from "rcskin/spectra";
import { initial, read, written } from "rcskin/state";
import { Station } from "rcskin/station";
import { csv, pressText, save, toml } from "rcskin/takeaway";

/** @typedef {import("rcskin/skin").Touch} Touch */
/** @typedef {import("rcskin/state").State} State */

const FEW_DRAWS = 3;
const MANY_DRAWS = 20;
const PATIENCE = 250; // ms without change until rates are estimated with many draws, and the address is updated
const TURN = 2500; // ms for the phase to run once around

const data = JSON.parse(element("data").textContent);
const skin = new Skin(data);
const first = initial(data);
let state = read(location.hash.slice(1), first, data);
const station = new Station(skin, () => state);
const charts = new SpectraCharts(element, skin.frequencies);
const controls = new Controls(data, () => state, set, setStrength);
const gestures = new Gestures(element("skin"), skin, {
  whole: () => state.whole || skin.outline.groups !== null,
  factor: () => state.strength,
  strengthen: (by) => setStrength(state.strength + by),
  changed: press,
});

/** Access for the program that the page is linked to. */
export const page = { data, skin, station, gestures, element, state: () => state };

/** @type {Touch[]} */
let last = [];
let measured = station.measure();
let field = fieldNow();
const waiting = { picture: 0, quiet: 0, cast: true };

function fieldNow() {
  return skin.field(state.drive, state.touches, state.at, station.cast);
}

/** @param {Touch[]} touches */
function press(touches) {
  const pressed = touches.map((touch) =>
    touch.finger === undefined ? station.pressed(touch) : touch,
  );
  if (pressText(pressed) !== pressText(state.touches)) {
    if (state.touches.length) last = state.touches;
    state.touches = pressed;
  }
  refresh(false);
}

/** Presses the same touches anew, by a finger or a rod as the switch is set. */
function touchAnew() {
  state.touches = state.touches.map(({ finger: _, ...rod }) => station.pressed(rod));
  gestures.touches = state.touches;
}

/** @param {Partial<State>} values @param {boolean} cast */
function set(values, cast) {
  Object.assign(state, values);
  if (values.earthed !== undefined) touchAnew();
  controls.tell();
  if (values.running) requestAnimationFrame(run);
  refresh(cast);
}

/** Sets the strength of the latest touch and of the next. @param {number} factor */
function setStrength(factor) {
  const strength = Math.min(Math.max(Number(factor.toFixed(3)), 1), 1 + data.range.rise[1]);
  const touches = state.touches.map((touch, k) =>
    k === state.touches.length - 1 ? { ...touch, factor: strength } : touch,
  );
  gestures.touches = touches;
  set({ strength, touches }, false);
  element("strength").value = strength;
}

/** Draws everything once before the next frame of the screen, however often it is called. @param {boolean} cast true if the skin or its readings have changed */
function refresh(cast) {
  waiting.cast ||= cast;
  if (waiting.picture) return;
  waiting.picture = requestAnimationFrame(() => {
    waiting.picture = 0;
    if (waiting.cast) {
      station.renew(true);
      showSeparation(FEW_DRAWS);
    }
    draw();
    performance.mark("rcskin-drawn");
    window.dispatchEvent(new Event("rcskin-drawn"));
    clearTimeout(waiting.quiet);
    waiting.quiet = window.setTimeout(settle, PATIENCE);
  });
}

/** Computes what takes longer, once nothing moves. */
function settle() {
  if (station.few) {
    station.renew(false);
    draw();
  }
  if (waiting.cast) showSeparation(MANY_DRAWS);
  waiting.cast = false;
  const text = written(state, first);
  history.replaceState(null, "", text ? `#${text}` : location.pathname + location.search);
}

function draw() {
  for (const id of ["skin", "belief"]) fit(element(id), data.skin);
  measured = station.measure();
  field = fieldNow();
  drawField(null);
  const { drive, at } = state;
  const spectra = {
    rest: station.exact([])[drive],
    last: last.length ? station.exact(last)[drive] : [],
    now: measured.Z[drive],
    heldAgainst: measured.rest[drive],
  };
  charts.draw(spectra, station.noise, skin.frequencies[at]);
  element("reading").textContent = charts.inWords(spectra, at);
  const located = station.localizer.locate(measured.Z, measured.rest);
  drawBelief(element("belief"), skin, station.localizer.classes, located.chances);
  element("belief").setAttribute("aria-label", located.words);
  if (element("answer").textContent !== located.words)
    element("answer").textContent = located.words;
}

/** @param {number | null} phase rad, null for the amplitude alone */
function drawField(phase) {
  const { high, low } = data.interfaces[state.drive];
  const { arrows, touches } = state;
  const shown = { phase, arrows, touches, cursor: gestures.pointed, driven: [...high, ...low] };
  const { least, most } = drawSkin(element("skin"), skin, field, shown);
  const volts = (/** @type {number} */ value) => withPrefix(value, "V");
  const colours =
    phase === null
      ? `dark ${volts(least)}, yellow ${volts(most)}`
      : `at one moment, blue -${volts(most)}, orange +${volts(most)}`;
  const at = withPrefix(skin.frequencies[state.at], "Hz");
  element("legend").textContent =
    `Difference of potential between the sheets: ${colours}, for 1 V at the foils, at ${at}.`;
}

/** @param {number} time ms */
function run(time) {
  if (!state.running) return refresh(false);
  drawField((2 * Math.PI * time) / TURN);
  requestAnimationFrame(run);
}

/** @param {number} draws */
function showSeparation(draws) {
  const { localizer } = station;
  const { column, row, pixel, nearest } = localizer.apart(data.press.factor_spread, draws);
  const percent = (/** @type {number} */ share) => `${Math.round(100 * share)} %`;
  const name = (/** @type {number} */ k) =>
    k === 0
      ? "nothing pressed"
      : `pixel ${localizer.classes[k].row},${localizer.classes[k].column}`;
  element("apart").textContent =
    `Localized correctly, about: columns ${percent(column)}, rows ${percent(row)}, pixels ${percent(pixel)}. ` +
    `Hardest to distinguish: ${name(nearest.first)} and ${name(nearest.second)}, ` +
    `${nearest.distance.toPrecision(2)} standard errors apart.`;
}

function takeSweep() {
  const sweeps = [
    { touches: [], Z: station.displayed(measured.rest) },
    { touches: measured.touches, Z: station.displayed(measured.Z) },
  ];
  save(`${data.name}.csv`, csv(data, sweeps));
}

function reset() {
  state = structuredClone(first);
  controls.show();
  gestures.set([]);
  refresh(true);
}

/** Shows what fits into another page, and sends that page the height. */
function embed() {
  document.body.classList.add("embedded");
  const send = () => window.parent.postMessage({ height: document.body.offsetHeight }, "*");
  new ResizeObserver(send).observe(document.body);
}

function begin() {
  const { rows, columns } = skin.model.grid;
  element("honest").textContent =
    `Simulated by rcskin: Rs and Cp are within ${data.rtol} of the finite-element solver's. ` +
    (skin.outline.groups
      ? "Pixels are groups of its mesh's elements."
      : `Other touches than whole pixels are resolved on ${rows} x ${columns} cells.`);
  const clicks = {
    release: () => gestures.set([]),
    csv: takeSweep,
    toml: () => save(`${data.name}.toml`, toml(data, state)),
    again: () => set({ seed: state.seed + 1 }, false),
    reset,
  };
  for (const [id, act] of Object.entries(clicks)) element(id).addEventListener("click", act);
  window.addEventListener("resize", () => refresh(false));
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => refresh(false));
  if (window.parent !== window) embed();
  gestures.touches = state.touches;
  controls.show();
  refresh(true);
  if (state.running) requestAnimationFrame(run);
}

begin();

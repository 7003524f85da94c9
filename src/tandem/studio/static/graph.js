/**
 * The precedence graph: tasks as boxes, "must be done before" as arrows. Dragging from one task to
 * another adds an arrow, Delete takes the chosen one away; an arrow that would close a circle is
 * refused, and the circle is named. A box takes the keyboard too: Enter begins an arrow, arrow keys
 * lead to the other end, Enter sets it.
 * @module
 */
import * as api from "./api.js";
import { barName, cell, edit, picked, point, say, work } from "./state.js";
import { looksOf } from "./looks.js";
import { moment } from "./gantt.js";
import { t } from "./words.js";
import { computed, effect, html, observed, signal, useRef } from "./view.js";

/** @typedef {[number, number]} Place column and row, or pixels from them. */
/** @typedef {{node: Place, at: Map<string, Place>, curves: Map<string, Place[]>}} Layers where tasks stand and how arrows run, by the server. */

const HEIGHT = 40;
const LEAST_WIDTH = 88;
const MOST_LETTERS = 22;
const MARGIN = 12;
const HOLD_PX = 4;

/** The task from which an arrow is being drawn, and where its tip is. */
const drawing = signal(/** @type {{from: string, x: number, y: number, over: string | null, keyed: boolean} | null} */ (null));
/** The arrow that was chosen. */
const chosen = signal(/** @type {{from: string, to: string} | null} */ (null));

/** @param {unknown} after @returns {string[]} */
const namesIn = (after) => (Array.isArray(after) ? after : typeof after === "string" ? [after] : []).filter((name) => typeof name === "string");

/** @param {import("./ordered.js").Task} task @returns {string[]} whose end it waits from by `wait`. */
const waitedFrom = (task) =>
  [task.wait ?? []].flat().flatMap((/** @type {any} */ one) => (one && typeof one === "object" && (one.between ?? "end-start") === "end-start" ? namesIn(one.after) : []));

/** @returns {{from: string, to: string, wait: boolean}[]} the arrows of the cell between tasks that it has. */
const arrowsOf = (/** @type {import("./ordered.js").Cell} */ now) => {
  const names = new Set(now.tasks.map((task) => task.name));
  return now.tasks.flatMap((task) => {
    const after = namesIn(task.after);
    const waited = waitedFrom(task).filter((from) => !after.includes(from));
    return [...after.map((from) => ({ from, to: task.name, wait: false })), ...waited.map((from) => ({ from, to: task.name, wait: true }))].filter(({ from }) => names.has(from));
  });
};

/** What the layout depends on: names and arrows, as a text that changes only when they do. */
const shape = computed(() => {
  const arrows = arrowsOf(cell.value);
  return JSON.stringify([...new Set(cell.value.tasks.map((task) => task.name))].map((name) => [name, arrows.filter(({ to }) => to === name).map(({ from }) => from)]));
});
/** As the server laid it out last; it may be of a cell that has changed since. */
const layers = signal(/** @type {Layers} */ ({ node: [1, 1], at: new Map(), curves: new Map() }));

let latest = 0;
/** Asks anew for the layout whenever tasks or arrows are others; the last answer counts. */
export function watchGraph() {
  effect(() => {
    if (work.value) askLayers(++latest, shape.value);
  });
}

/** @param {number} turn @param {string} asked */
async function askLayers(turn, asked) {
  try {
    const { status, document } = await api.graph({ after: JSON.parse(asked) });
    if (turn !== latest || status !== 200) return;
    layers.value = {
      node: document.node,
      at: new Map(document.at.map((/** @type {any} */ one) => [one.task, one.at])),
      curves: new Map(document.arrows.map((/** @type {any} */ one) => [`${one.after}\n${one.task}`, one.curve])),
    };
  } catch (error) {
    if (!(error instanceof api.Unreachable)) throw error;
  }
}

/** The same in pixels: all tasks are as wide as the widest. */
const layout = computed(() => {
  const { node, at, curves } = layers.value;
  const longest = Math.min(MOST_LETTERS, Math.max(0, ...[...at.keys()].map((name) => name.length)));
  const width = Math.max(LEAST_WIDTH, 9 * longest + 24);
  const pitch = [width / node[0], HEIGHT / node[1]];
  /** @param {Place} place @returns {Place} */
  const pixels = ([column, row]) => [MARGIN + width / 2 + column * pitch[0], MARGIN + HEIGHT / 2 + row * pitch[1]];
  const places = new Map([...at].map(([name, place]) => [name, pixels(place)]));
  const edges = [...places.values()];
  return {
    width,
    places,
    curves: new Map([...curves].map(([arrow, curve]) => [arrow, curve.map(pixels)])),
    size: [Math.max(200, ...edges.map(([x]) => x + width / 2 + MARGIN)), Math.max(80, ...edges.map(([, y]) => y + HEIGHT / 2 + MARGIN))],
  };
});

/** @param {Map<string, string[]>} next @param {string} from @param {string} to @returns {string[] | null} the tasks on a way along the arrows. */
function pathBetween(next, from, to) {
  const before = new Map([[from, ""]]);
  const open = [from];
  for (let name = open.pop(); name !== undefined; name = open.pop()) {
    if (name === to) {
      const way = [to];
      while (way[0] !== from) way.unshift(/** @type {string} */ (before.get(way[0])));
      return way;
    }
    for (const one of next.get(name) ?? [])
      if (!before.has(one)) {
        before.set(one, name);
        open.push(one);
      }
  }
  return null;
}

/** Adds an arrow, unless it is there, or closes a circle. @param {string} from @param {string} to */
function link(from, to) {
  if (from === to) return;
  const arrows = arrowsOf(cell.value);
  if (arrows.some((one) => one.from === from && one.to === to)) return say("status.arrow_there", { from, to });
  const next = new Map(cell.value.tasks.map((task) => [task.name, /** @type {string[]} */ ([])]));
  for (const one of arrows) next.get(one.from)?.push(one.to);
  const way = pathBetween(next, to, from);
  if (way) return say("status.circle", { from, to, way: [...way, to].join(" → ") }, "bad");
  edit((now) => ({
    ...now,
    tasks: now.tasks.map((task) => (task.name === to ? { ...task, after: [...namesIn(task.after), from] } : task)),
  }));
  say("status.arrow_added", { from, to });
}

/** @param {string} from @param {string} to */
function unlink(from, to) {
  edit((now) => ({
    ...now,
    tasks: now.tasks.map((task) => {
      if (task.name !== to) return task;
      const { after, ...rest } = task;
      const left = namesIn(after).filter((name) => name !== from);
      return left.length ? { ...task, after: left } : rest;
    }),
  }));
  chosen.value = null;
  say("status.arrow_deleted", { from, to });
}

/** @param {Place[]} points a start and threes of control points. @returns {string} */
const path = ([[x, y], ...rest]) => `M${x},${y}C${rest.map((place) => place.join(",")).join(" ")}`;

/** @param {Place} one @param {Place} other @param {number} width @returns {string} a bow between two boxes, around those between them. */
function bow([x1, y1], [x2, y2], width) {
  const [from, to] = [x1 + width / 2, x2 - width / 2];
  const bend = Math.min(60, (to - from) / 3) * (y1 > y2 ? 1 : -1);
  return `M${from},${y1}Q${(from + to) / 2},${(y1 + y2) / 2 + bend} ${to},${y2}`;
}

export const Graph = observed(() => {
  const svg = useRef(/** @type {SVGSVGElement | null} */ (null));
  const { width, places, curves, size } = layout.value;
  if (cell.value.tasks.length === 0) return null;
  const arrows = arrowsOf(cell.value).flatMap(({ from, to, wait }) => {
    const [one, other] = [places.get(from), places.get(to)];
    const curve = curves.get(`${from}\n${to}`);
    if (!one || !other) return [];
    // An arrow that others imply has no way of its own among them.
    return [{ from, to, wait, thin: !curve, way: curve ? path(curve) : bow(one, other, width) }];
  });
  return html`
    <div class="heading"><h2>${t("graph.title")}</h2></div>
    <div class="graph">
      <svg ref=${svg} role="group" aria-label=${t("graph.title")} width=${size[0]} height=${size[1]} viewBox="0 0 ${size[0]} ${size[1]}">
        <defs>
          <marker id="tip" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="8" markerHeight="8" orient="auto"><path d="M0,0L8,4L0,8z" class="tip" /></marker>
        </defs>
        ${arrows.map(({ from, to, way, thin, wait }) =>
          wait
            ? html`<g class="arrow wait" key=${`${from}\n${to}`}><title>${t("graph.wait", { from, to })}</title><path class="line" d=${way} marker-end="url(#tip)" /></g>`
            : html`<${Arrow} key=${`${from}\n${to}`} from=${from} to=${to} way=${way} thin=${thin} />`,
        )}
        ${cell.value.tasks.map(({ name }) => {
          const place = places.get(name);
          return place && html`<${Node} key=${name} name=${name} x=${place[0]} y=${place[1]} width=${width} svg=${svg} />`;
        })}
        <${Drawn} />
      </svg>
    </div>
    <p class="hint">${t("graph.hint")}</p>
  `;
});

const Arrow = observed((/** @type {{from: string, to: string, way: string, thin: boolean}} */ { from, to, way, thin }) => {
  const is = chosen.value?.from === from && chosen.value.to === to;
  return html`<g
    class="arrow ${thin ? "thin" : ""} ${is ? "chosen" : ""}"
    role="button"
    tabindex="0"
    aria-label=${t("graph.arrow", { from, to })}
    onClick=${() => (chosen.value = { from, to })}
    onFocus=${() => (chosen.value = { from, to })}
    onBlur=${() => (chosen.value = null)}
    onKeyDown=${(/** @type {KeyboardEvent} */ event) => {
      if (event.key !== "Delete" && event.key !== "Backspace") return;
      event.preventDefault();
      unlink(from, to);
    }}
  ><path class="reach" d=${way} /><path class="line" d=${way} marker-end="url(#tip)" /></g>`;
});

/** How far a task is at the moment that the player shows: "" before, "going", "done". @param {string} name */
function progressOf(name) {
  const one = point.value?.assignments.find((a) => a.task === name);
  if (moment.value === null || !one || moment.value < one.start) return "";
  return moment.value < one.end ? "going" : "done";
}

const Node = observed((/** @type {{name: string, x: number, y: number, width: number, svg: any}} */ { name, x, y, width, svg }) => {
  const one = point.value?.assignments.find((a) => a.task === name);
  const look = one && looksOf(cell.value).get(one.operators[0]);
  const over = drawing.value?.over === name;
  return html`<g
    class="node ${look ? look.class : "free"} ${over ? "over" : ""} ${picked.value === name ? "picked" : ""} ${progressOf(name)}"
    transform="translate(${x - width / 2} ${y - HEIGHT / 2})"
    role="button"
    tabindex="0"
    data-node=${name}
    aria-label=${t("graph.node", { task: name })}
    aria-description=${one ? barName(one) : undefined}
    onPointerDown=${(/** @type {PointerEvent} */ event) => begin(event, name, svg.current)}
    onKeyDown=${(/** @type {KeyboardEvent} */ event) => onKey(event, name)}
  ><title>${name}</title><rect width=${width} height=${HEIGHT} rx="4" /><text x=${width / 2} y=${HEIGHT / 2 + 5} text-anchor="middle">${short(name)}</text></g>`;
});

/** @param {string} name @returns {string} as much of it as a box holds. */
const short = (name) => (name.length > MOST_LETTERS ? `${name.slice(0, MOST_LETTERS - 1)}…` : name);

const Drawn = observed(() => {
  const now = drawing.value;
  const { places, width } = layout.value;
  const from = now && places.get(now.from);
  if (!now || !from) return null;
  const tip = (now.keyed && now.over && places.get(now.over)) || [now.x, now.y];
  return html`<path class="drawn" marker-end="url(#tip)" d="M${from[0] + width / 2},${from[1]}L${tip[0]},${tip[1]}" />`;
});

/** @param {PointerEvent} event @param {string} from @param {SVGSVGElement} svg */
function begin(event, from, svg) {
  if (event.button !== 0) return;
  picked.value = from;
  const { clientX, clientY } = event;
  /** @param {PointerEvent} moved */
  const move = (moved) => {
    if (!drawing.value && Math.hypot(moved.clientX - clientX, moved.clientY - clientY) < HOLD_PX) return;
    const box = svg.getBoundingClientRect();
    const shrink = svg.viewBox.baseVal.width / box.width;
    drawing.value = { from, x: (moved.clientX - box.left) * shrink, y: (moved.clientY - box.top) * shrink, over: nodeAt(moved), keyed: false };
  };
  /** @param {boolean} keep @param {PointerEvent} [up] */
  const finish = (keep, up) => {
    for (const [name, act] of listeners) removeEventListener(name, act, true);
    const to = up && drawing.value ? nodeAt(up) : null;
    drawing.value = null;
    if (keep && to) link(from, to);
  };
  const listeners = /** @type {[string, any][]} */ ([
    ["pointermove", move],
    ["pointerup", (/** @type {PointerEvent} */ up) => finish(true, up)],
    ["pointercancel", () => finish(false)],
    ["keydown", (/** @type {KeyboardEvent} */ key) => key.key === "Escape" && finish(false)],
  ]);
  for (const [name, act] of listeners) addEventListener(name, act, true);
  event.preventDefault();
  /** @type {HTMLElement} */ (event.currentTarget).focus();
}

/** @param {PointerEvent} event @returns {string | null} the task under the pointer. */
function nodeAt(event) {
  const hit = document.elementFromPoint(event.clientX, event.clientY)?.closest("[data-node]");
  return hit?.getAttribute("data-node") ?? null;
}

/** @param {KeyboardEvent} event @param {string} name */
function onKey(event, name) {
  const now = drawing.value;
  const names = cell.value.tasks.map((task) => task.name);
  if (event.key === "Enter" && !now) {
    drawing.value = { from: name, x: 0, y: 0, over: names[(names.indexOf(name) + 1) % names.length], keyed: true };
    say("status.arrow_to", { from: name, to: drawing.value.over });
  } else if (now?.keyed && event.key === "Enter") {
    drawing.value = null;
    if (now.over) link(now.from, now.over);
  } else if (now?.keyed && event.key === "Escape") drawing.value = null;
  else if (now?.keyed && event.key.startsWith("Arrow")) {
    const by = event.key === "ArrowRight" || event.key === "ArrowDown" ? 1 : -1;
    const over = names[(names.indexOf(now.over ?? name) + by + names.length) % names.length];
    drawing.value = { ...now, over };
    say("status.arrow_to", { from: name, to: over });
  } else return;
  event.preventDefault();
}

/**
 * The precedence graph: tasks as boxes, "must be done before" as arrows. Dragging from one task to
 * another adds an arrow, Delete takes the chosen one away; an arrow that would close a circle is
 * refused, and the circle is named. A box takes the keyboard too: Enter begins an arrow, arrow keys
 * lead to the other end, Enter sets it.
 * @module
 */
import * as dagre from "./vendor/dagre.js";
import { barName, cell, edit, picked, point, say } from "./state.js";
import { looksOf } from "./looks.js";
import { moment } from "./gantt.js";
import { t } from "./words.js";
import { computed, html, observed, signal, useRef } from "./view.js";

const NODE = { width: 64, height: 40 };
const HOLD_PX = 4;

/** The task from which an arrow is being drawn, and where its tip is. */
const drawing = signal(/** @type {{from: string, x: number, y: number, over: string | null, keyed: boolean} | null} */ (null));
/** The arrow that was chosen. */
const chosen = signal(/** @type {{from: string, to: string} | null} */ (null));

/** @returns {[string, string][]} the arrows of the cell between tasks that it has. */
const arrowsOf = (/** @type {import("./ordered.js").Cell} */ now) => {
  const names = new Set(now.tasks.map((task) => task.name));
  return now.tasks.flatMap((task) =>
    (Array.isArray(task.after) ? task.after : []).filter((from) => names.has(from)).map((from) => /** @type {[string, string]} */ ([from, task.name])),
  );
};

/** What the layout depends on: names and arrows, as a text that changes only when they do. */
const shape = computed(() => JSON.stringify([cell.value.tasks.map((task) => task.name), arrowsOf(cell.value)]));
const layout = computed(() => {
  const [names, arrows] = /** @type {[string[], [string, string][]]} */ (JSON.parse(shape.value));
  const graph = new dagre.Graph();
  graph.setGraph({ rankdir: "LR", nodesep: 18, ranksep: 44, marginx: 12, marginy: 12 });
  graph.setDefaultEdgeLabel(() => ({}));
  for (const name of new Set(names)) graph.setNode(name, { width: Math.max(NODE.width, 9 * name.length + 24), height: NODE.height });
  // An arrow that others imply is drawn thin and curved; the layout does better without it.
  const implied = impliedOf(names, arrows);
  for (const [from, to] of arrows) if (!implied.has(`${from}\n${to}`)) graph.setEdge(from, to);
  dagre.layout(graph);
  return { graph, arrows, implied };
});

/** @param {string[]} names @param {[string, string][]} arrows @returns {Set<string>} the arrows that follow from others. */
function impliedOf(names, arrows) {
  const next = new Map(names.map((name) => [name, /** @type {string[]} */ ([])]));
  for (const [from, to] of arrows) next.get(from)?.push(to);
  const found = new Set();
  for (const [from, to] of arrows) {
    const others = (next.get(from) ?? []).filter((name) => name !== to);
    if (others.some((name) => reaches(next, name, to))) found.add(`${from}\n${to}`);
  }
  return found;
}

/** @param {Map<string, string[]>} next @param {string} from @param {string} to */
const reaches = (next, from, to) => pathBetween(next, from, to) !== null;

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
  if (arrows.some(([one, other]) => one === from && other === to)) return say("status.arrow_there", { from, to });
  const next = new Map(cell.value.tasks.map((task) => [task.name, /** @type {string[]} */ ([])]));
  for (const [one, other] of arrows) next.get(one)?.push(other);
  const way = pathBetween(next, to, from);
  if (way) return say("status.circle", { from, to, way: [...way, to].join(" → ") }, "bad");
  edit((now) => ({
    ...now,
    tasks: now.tasks.map((task) => (task.name === to ? { ...task, after: [...(Array.isArray(task.after) ? task.after : []), from] } : task)),
  }));
  say("status.arrow_added", { from, to });
}

/** @param {string} from @param {string} to */
function unlink(from, to) {
  edit((now) => ({
    ...now,
    tasks: now.tasks.map((task) => {
      if (task.name !== to || !Array.isArray(task.after)) return task;
      const { after, ...rest } = task;
      const left = task.after.filter((name) => name !== from);
      return left.length ? { ...task, after: left } : rest;
    }),
  }));
  chosen.value = null;
  say("status.arrow_deleted", { from, to });
}

/** @param {{x: number, y: number}[]} points @returns {string} */
const path = (points) => points.map((p, i) => `${i ? "L" : "M"}${p.x},${p.y}`).join("");

/** @param {any} one @param {any} other @returns {string} a bow between two boxes, around those between them. */
function curve(one, other) {
  const [x1, x2] = [one.x + one.width / 2, other.x - other.width / 2];
  const bow = Math.min(60, (x2 - x1) / 3) * (one.y > other.y ? 1 : -1);
  return `M${x1},${one.y}Q${(x1 + x2) / 2},${(one.y + other.y) / 2 + bow} ${x2},${other.y}`;
}

export const Graph = observed(() => {
  const svg = useRef(/** @type {SVGSVGElement | null} */ (null));
  const { graph, arrows, implied } = layout.value;
  const { width = 0, height = 0 } = graph.graph();
  if (cell.value.tasks.length === 0) return null;
  return html`
    <div class="heading"><h2>${t("graph.title")}</h2></div>
    <div class="graph">
      <svg
        ref=${svg}
        role="group"
        aria-label=${t("graph.title")}
        width=${Math.max(width, 200)}
        height=${Math.max(height, 80)}
        viewBox="0 0 ${Math.max(width, 200)} ${Math.max(height, 80)}"
      >
        <defs>
          <marker id="tip" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="8" markerHeight="8" orient="auto"><path d="M0,0L8,4L0,8z" class="tip" /></marker>
        </defs>
        ${arrows.map(([from, to]) => {
          const thin = implied.has(`${from}\n${to}`);
          return html`<${Arrow} key=${`${from}\n${to}`} from=${from} to=${to} way=${thin ? curve(graph.node(from), graph.node(to)) : path(graph.edge(from, to).points)} thin=${thin} />`;
        })}
        ${graph.nodes().map((/** @type {string} */ name) => {
          const { x, y, width } = graph.node(name);
          return html`<${Node} key=${name} name=${name} x=${x} y=${y} width=${width} svg=${svg} />`;
        })}
        <${Drawn} graph=${graph} />
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
    transform="translate(${x - width / 2} ${y - NODE.height / 2})"
    role="button"
    tabindex="0"
    data-node=${name}
    aria-label=${t("graph.node", { task: name })}
    aria-description=${one ? barName(one) : undefined}
    onPointerDown=${(/** @type {PointerEvent} */ event) => begin(event, name, svg.current)}
    onKeyDown=${(/** @type {KeyboardEvent} */ event) => onKey(event, name)}
  ><rect width=${width} height=${NODE.height} rx="4" /><text x=${width / 2} y=${NODE.height / 2 + 5} text-anchor="middle">${name}</text></g>`;
});

const Drawn = observed((/** @type {{graph: any}} */ { graph }) => {
  const now = drawing.value;
  if (!now) return null;
  const from = graph.node(now.from);
  const tip = now.keyed && now.over ? graph.node(now.over) : now;
  return html`<path class="drawn" marker-end="url(#tip)" d=${path([{ x: from.x + from.width / 2, y: from.y }, tip])} />`;
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

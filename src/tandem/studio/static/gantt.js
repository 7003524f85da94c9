/**
 * The Gantt chart: a lane for each operator, a button for each bar. A bar is taken with the mouse or
 * with the arrow keys; while it is carried, only its outline moves, and the server says what it would
 * mean. Let go, it stays, if its cell allows that.
 * @module
 */
import { ticks } from "./front.js";
import { looksOf } from "./looks.js";
import { isCritical, kindsShaded, laneOf, measures, whyThen } from "./measures.js";
import {
  barName, cell, discardProposal, drop, ghosts, keepProposal, locks, picked, point, pointName, proposal, resolveRest, say, stale, hand, toggleLock, verdictOn,
} from "./state.js";
import { shown, t } from "./words.js";
import { batch, computed, html, observed, signal, useLayoutEffect, useRef } from "./view.js";

/** @typedef {import("./state.js").Assignment} Assignment */
/** @typedef {{task: string, from: Assignment, operators: string[], start: number, length: number, x0: number, y0: number, live: boolean, keyed: boolean, verdict: any}} Carried */

const LANE = 58;
const HEAD = 28;
const SNAP_PX = 9;
const HOLD_PX = 4;
const LEAST_SCALE = 1.2;

/** The bar that is being carried. */
const carried = signal(/** @type {Carried | null} */ (null));
/** Per operator, why it cannot take the carried bar; null while it can. */
const barred = signal(/** @type {Record<string, string | null>} */ ({}));
const width = signal(800);
/** How often the plan is wider than the window. */
const zoom = signal(1);
/** The moment that the player shows; null when it does not play. */
export const moment = signal(/** @type {number | null} */ (null));

/** When the schedule on show and its ghosts have ended, seconds. */
const end = computed(() => [...(point.value?.assignments ?? []), ...ghosts.value].reduce((last, one) => Math.max(last, one.end), point.value?.makespan || 1));
/** The same with the bar that is carried, which makes the lanes longer but not finer. */
const reach = computed(() => (carried.value?.live ? Math.max(end.value, carried.value.start + carried.value.length) : end.value));
/** Pixels per second. */
const scale = computed(() => Math.max(LEAST_SCALE, ((width.value - 24) / end.value) * zoom.value));
const lanes = () => cell.value.operators.map((operator) => operator.name);

export const Gantt = observed(() => {
  const now = point.value;
  const frame = useRef(/** @type {HTMLElement | null} */ (null));
  const shownYet = Boolean(now);
  useLayoutEffect(() => {
    if (!frame.current) return;
    const measure = () => (width.value = frame.current?.clientWidth ?? 800);
    const watch = new ResizeObserver(measure);
    watch.observe(frame.current);
    measure();
    return () => watch.disconnect();
  }, [shownYet]);
  if (!now) return html`<p class="empty">${t("gantt.empty")}</p>`;
  return html`
    <${Heading} />
    <div class="gantt">
      <div class="names">${cell.value.operators.map((operator) => html`<${LaneName} key=${operator.name} name=${operator.name} />`)}</div>
      <div class="window" ref=${frame}>
        <div class="lanes" style=${{ width: `${reach.value * scale.value + 24}px`, height: `${HEAD + LANE * lanes().length}px` }}>
          <${Axis} />
          ${lanes().map((name, row) => html`<${Lane} key=${name} name=${name} row=${row} />`)}
          <${Joints} />
          <${Ghosts} />
          <${Bars} />
          <${Outline} />
          <${Now} />
        </div>
      </div>
    </div>
    <${Legend} />
    <${Readout} />
    <${Faults} />
  `;
});

const Heading = observed(() => {
  const now = point.value;
  if (!now) return null;
  const kind = proposal.value ? "gantt.proposed" : hand.value ? "gantt.by_hand" : "gantt.point";
  return html`
    <div class="heading">
      <h2>${t(kind, { point: pointName(now) })}</h2>
      ${stale.value ? html`<span class="badge">${t("gantt.stale")}</span>` : null}
      <span class="tools">
        <button onClick=${() => (zoom.value = Math.max(1, zoom.value / 1.5))} aria-label=${t("gantt.zoom_out")} disabled=${zoom.value <= 1}>−</button>
        <button onClick=${() => (zoom.value = Math.min(40, zoom.value * 1.5))} aria-label=${t("gantt.zoom_in")}>+</button>
        ${proposal.value
          ? html`<button class="first" onClick=${keepProposal}>${t("button.keep")}</button><button onClick=${discardProposal}>${t("button.discard")}</button>`
          : html`<button onClick=${resolveRest} title=${t("gantt.resolve_hint")}>${t("button.resolve")}</button>`}
      </span>
    </div>
    ${proposal.value ? html`<p class="sentence">${proposal.value.sentence}</p>` : null}
  `;
});

const LaneName = observed((/** @type {{name: string}} */ { name }) => {
  const look = looksOf(cell.value).get(name);
  const told = laneOf.value.get(name);
  return html`<div class="lane-name">
    <span class="swatch ${look?.class}" aria-hidden="true"></span>
    <b>${look?.label}</b>
    <span class="faint">${told ? t("gantt.busy", { busy: told.busy, share: Math.round(100 * told.share) }) : ""}</span>
  </div>`;
});

const Axis = observed(() => {
  const step = scale.value;
  return html`<div class="axis" aria-hidden="true">
    ${ticks(0, end.value, (end.value * step) / 70).map(
      (value) => html`<span key=${value} style=${{ left: `${value * step}px` }}>${shown(value)}</span>`,
    )}
    <span class="makespan" style=${{ left: `${(point.value?.makespan ?? 0) * step}px` }}></span>
  </div>`;
});

const Lane = observed((/** @type {{name: string, row: number}} */ { name, row }) => {
  const why = barred.value[name];
  const told = laneOf.value.get(name);
  const step = scale.value;
  return html`<div class="lane ${why ? "barred" : ""}" data-lane=${name} style=${{ top: `${HEAD + row * LANE}px`, height: `${LANE}px` }}>
    ${told?.shaded.map(
      (off) => html`<span
        class="off ${off.kind}"
        key=${`${off.kind}/${off.start}`}
        style=${{ left: `${off.start * step}px`, width: `${(off.end - off.start) * step}px` }}
        title=${offWords(off)}
      ></span>`,
    )}
    ${told?.waits.map(
      (wait) => html`<span
        class="wait"
        key=${`${wait.task}/${wait.start}`}
        style=${{ left: `${wait.start * step}px`, width: `${(wait.end - wait.start) * step}px` }}
        title=${t("gantt.wait", wait)}
      ></span>`,
    )}
    ${why ? html`<span class="reason">${why}</span>` : null}
  </div>`;
});

/** @param {import("./measures.js").Shaded} off */
const offWords = (off) => t(`gantt.${off.kind}`, off);

/** A line from lane to lane for each task that several do together. */
const Joints = observed(() => {
  const rows = lanes();
  return (point.value?.assignments ?? [])
    .filter((one) => one.operators.length > 1)
    .map((one) => {
      const places = one.operators.map((name) => rows.indexOf(name)).filter((row) => row >= 0);
      const [top, bottom] = [Math.min(...places), Math.max(...places)];
      const middle = ((one.start + one.end) / 2) * scale.value;
      return html`<span class="joint" aria-hidden="true" key=${one.task} style=${{ left: `${middle}px`, top: `${HEAD + top * LANE + LANE / 2}px`, height: `${(bottom - top) * LANE}px` }}></span>`;
    });
});

/** What the signs beside the bars mean, as far as they are on show. */
const Legend = observed(() => {
  const waits = measures.value?.lanes?.some((lane) => lane.waits.length > 0);
  const joints = point.value?.assignments.some((one) => one.operators.length > 1);
  if (kindsShaded.value.length === 0 && !waits && !joints) return null;
  return html`<p class="key">
    ${kindsShaded.value.map((kind) => html`<span key=${kind}><span class="swatch off ${kind}" aria-hidden="true"></span> ${t(`key.${kind}`)}</span>`)}
    ${joints ? html`<span><span class="joint" aria-hidden="true"></span> ${t("key.joint")}</span>` : null}
    ${waits ? html`<span><span class="swatch wait" aria-hidden="true"></span> ${t("key.wait")}</span>` : null}
  </p>`;
});

const Ghosts = observed(() => {
  const now = new Map((point.value?.assignments ?? []).map((one) => [one.task, one]));
  const rows = lanes();
  return ghosts.value
    .filter((old) => {
      const one = now.get(old.task);
      return !one || one.start !== old.start || one.operators.join() !== old.operators.join();
    })
    .flatMap((old) =>
      old.operators.map((name) => html`<span class="ghost" aria-hidden="true" key=${`${old.task}/${name}`} style=${box(old.start, old.end - old.start, rows.indexOf(name))}></span>`),
    );
});

/** @param {number} start @param {number} length @param {number} row */
function box(start, length, row) {
  const step = scale.value;
  return { left: `${start * step}px`, width: `${Math.max(length * step, 4)}px`, top: `${HEAD + row * LANE + 7}px`, height: `${LANE - 14}px` };
}

const Bars = observed(() => {
  const looks = looksOf(cell.value);
  const rows = lanes();
  const changed = new Map((proposal.value?.point.changed ?? []).map((one) => [one.task, one.what]));
  const labels = new Map(cell.value.tasks.map((task) => [task.name, task.label]));
  return (point.value?.assignments ?? []).flatMap((one) =>
    one.operators
      .filter((name) => rows.includes(name))
      .map((name, place) => {
        const locked = locks.value.includes(one.task);
        const look = looks.get(name);
        const title = labels.get(one.task) ? `${one.task}: ${labels.get(one.task)}` : one.task;
        return html`<button
          key=${`${one.task}/${place}`}
          class="bar ${look?.class} ${changed.has(one.task) ? "changed" : ""} ${locked ? "locked" : ""} ${isCritical(one.task) ? "critical" : ""}"
          style=${box(one.start, one.end - one.start, rows.indexOf(name))}
          aria-label=${barName(one) + (locked ? t("bar.locked") : "")}
          aria-description=${whyThen(one.task)}
          aria-pressed=${picked.value === one.task}
          title=${title}
          data-task=${one.task}
          onPointerDown=${(/** @type {PointerEvent} */ event) => take(event, one, name)}
          onKeyDown=${(/** @type {KeyboardEvent} */ event) => onKey(event, one, name)}
          onClick=${() => (picked.value = one.task)}
        ><span>${locked ? "🔒︎ " : ""}${one.task}</span></button>`;
      }),
  );
});

/** @param {{left: string, top: string, width: string, height: string}} box moved by the compositor alone, so that nothing below is painted anew. */
const onTop = ({ left, top, width, height }) => ({ transform: `translate(${left}, ${top})`, width, height });

/** The outline of the bar that is carried. */
const Outline = observed(() => {
  const now = carried.value;
  if (!now?.live) return null;
  const rows = lanes();
  const bad = now.verdict && (!now.verdict.allowed || now.verdict.faults.length > 0);
  return now.operators.map(
    (name) => html`<span class="carried ${bad ? "bad" : ""}" key=${name} style=${onTop(box(now.start, now.length, rows.indexOf(name)))}>${now.task}</span>`,
  );
});

/** What the carried bar would mean, in words. */
const Readout = observed(() => {
  const now = carried.value;
  return html`<p class="readout" aria-live="polite">${now?.live ? readout(now) : t("gantt.hint")}</p>`;
});

/** @param {Carried} now */
function readout(now) {
  const at = barName({ task: now.task, operators: now.operators, start: now.start, end: tidy(now.start + now.length) });
  const why = now.operators.map((name) => barred.value[name]).find(Boolean) ?? (now.verdict?.allowed === false ? now.verdict.reasons.join(" ") : null);
  if (why) return html`<b>${at}</b> · ${t("gantt.cannot")} ${why}`;
  if (!now.verdict) return html`<b>${at}</b>`;
  const faults = now.verdict.faults;
  return html`<b>${at}</b> → ${pointName(now.verdict)}${faults.length ? html` · ${t("gantt.faults", { n: faults.length })} ${faults[0]}` : null}`;
}

const Faults = observed(() => {
  const faults = proposal.value ? [] : (hand.value?.faults ?? []);
  if (faults.length === 0) return null;
  return html`<div class="faults"><b>${t("gantt.faults_title")}</b><ul>${faults.map((fault) => html`<li>${fault}</li>`)}</ul></div>`;
});

const Now = observed(() =>
  moment.value === null ? null : html`<span class="now" aria-hidden="true" style=${{ left: `${moment.value * scale.value}px` }}></span>`,
);

// ---- carrying a bar

/** @param {number} value @returns {number} without the digits that only the arithmetic made. */
const tidy = (value) => Math.round(value * 1e6) / 1e6;

/** @returns {number} the grid of times, seconds: whole ones where all of the plan are whole. */
const grid = () => ((point.value?.assignments ?? []).every((one) => Number.isInteger(one.start) && Number.isInteger(one.end)) ? 1 : 0.1);

/** @param {string} task @param {string[]} operators @param {number} otherwise @returns {number} seconds that they take by the cell file. */
function lengthOn(task, operators, otherwise) {
  const time = cell.value.tasks.find((one) => one.name === task)?.time ?? {};
  const seconds = operators.length === 1 ? time[operators[0]] : undefined;
  return typeof seconds === "number" ? seconds : otherwise;
}

/** @param {Assignment} one @param {number} x0 @param {number} y0 @param {boolean} keyed */
function begin(one, x0, y0, keyed) {
  batch(() => {
    barred.value = {};
    carried.value = { task: one.task, from: one, operators: one.operators, start: one.start, length: one.end - one.start, x0, y0, live: keyed, keyed, verdict: null };
  });
  if (keyed) askLanes(one);
}

/** Asks for each lane whether it can take the task at all. @param {Assignment} one */
async function askLanes(one) {
  if (one.operators.length > 1) return;
  await Promise.all(
    lanes().map(async (name) => {
      const verdict = name === one.operators[0] ? null : await verdictOn(one.task, [name], one.start);
      if (carried.value?.task !== one.task) return;
      const can = !verdict || verdict.ways?.some((/** @type {any} */ way) => way.operators.includes(name));
      barred.value = { ...barred.value, [name]: can ? null : verdict.reasons.join(" ") };
    }),
  );
}

/** Resolves once the frame that is due has been painted: what is written for the server delays no picture. */
const painted = () => new Promise((done) => requestAnimationFrame(() => setTimeout(done)));

let asking = false;
let again = false;
/** Asks what the carried bar would mean; one question at a time, the last one always. */
async function askVerdict() {
  if (asking) return (again = true);
  asking = true;
  try {
    do {
      await painted();
      again = false;
      const now = carried.value;
      if (!now) break;
      const verdict = await verdictOn(now.task, now.operators, now.start);
      const then = carried.value;
      if (then && then.task === now.task && then.start === now.start && then.operators.join() === now.operators.join())
        carried.value = { ...then, verdict, length: lengthIn(verdict, then) };
    } while (again);
  } finally {
    asking = false;
  }
}

/** @param {any} verdict @param {Carried} now @returns {number} seconds that the task takes there, by the server. */
function lengthIn(verdict, now) {
  const one = verdict.assignments?.find((/** @type {Assignment} */ other) => other.task === now.task);
  return one ? tidy(one.end - one.start) : now.length;
}

/** @param {string[]} operators @param {number} start */
function carryTo(operators, start) {
  const now = carried.value;
  if (!now) return;
  const to = Math.max(0, tidy(start));
  if (now.live && to === now.start && operators.join() === now.operators.join()) return;
  const same = operators.join() === now.from.operators.join();
  const length = same ? now.from.end - now.from.start : lengthOn(now.task, operators, now.from.end - now.from.start);
  carried.value = { ...now, operators, start: to, length, live: true, verdict: null };
  askVerdict();
}

/** @param {PointerEvent} event @param {Assignment} one @param {string} lane */
function take(event, one, lane) {
  if (event.button !== 0 || proposal.value) return;
  const button = /** @type {HTMLElement} */ (event.currentTarget);
  button.setPointerCapture(event.pointerId);
  begin(one, event.clientX, event.clientY, false);
  const others = (point.value?.assignments ?? []).filter((other) => other.task !== one.task).flatMap((other) => [other.start, other.end]);
  const marks = [0, ...others];
  /** @type {PointerEvent | null} */
  let last = null;
  let frame = 0;
  // Of all moves between two frames the last one counts, since no other is seen.
  const follow = (/** @type {PointerEvent} */ moved) => {
    last = moved;
    frame ||= requestAnimationFrame(move);
  };
  const move = () => {
    cancelAnimationFrame(frame);
    frame = 0;
    const now = carried.value;
    const moved = last;
    last = null;
    if (!now || !moved) return;
    const dx = moved.clientX - now.x0;
    const dy = moved.clientY - now.y0;
    if (!now.live) {
      if (Math.hypot(dx, dy) < HOLD_PX) return;
      button.classList.add("away");
      askLanes(one);
    }
    const operators = one.operators.length > 1 ? one.operators : [laneAt(lane, dy)];
    carryTo(operators, snapped(one.start + dx / scale.value, lengthOn(one.task, operators, now.length), marks, moved.altKey));
  };
  /** @param {boolean} keep */
  const finish = async (keep) => {
    for (const [name, act] of listeners) removeEventListener(name, act, true);
    if (keep) move();
    else cancelAnimationFrame(frame);
    button.classList.remove("away");
    const now = carried.value;
    letGo();
    if (keep && now?.live) {
      // The click that follows a drag is none.
      const swallow = (/** @type {Event} */ click) => click.stopPropagation();
      addEventListener("click", swallow, true);
      setTimeout(() => {
        removeEventListener("click", swallow, true);
        button.focus();
      });
      await put(now);
    }
  };
  const listeners = /** @type {[string, any][]} */ ([
    ["pointermove", follow],
    ["pointerup", () => finish(true)],
    ["pointercancel", () => finish(false)],
    ["keydown", (/** @type {KeyboardEvent} */ key) => key.key === "Escape" && (finish(false), say("status.cancelled"))],
  ]);
  for (const [name, act] of listeners) addEventListener(name, act, true);
}

/** @param {string} lane @param {number} dy @returns {string} the lane that many pixels below. */
function laneAt(lane, dy) {
  const rows = lanes();
  const row = rows.indexOf(lane) + Math.round(dy / LANE);
  return rows[Math.max(0, Math.min(rows.length - 1, row))];
}

/** @param {number} start @param {number} length @param {number[]} marks @param {boolean} free @returns {number} */
function snapped(start, length, marks, free) {
  const step = grid();
  const near = marks
    .flatMap((mark) => [mark, mark - length])
    .filter((to) => to >= 0 && Math.abs(to - start) * scale.value <= SNAP_PX)
    .sort((one, other) => Math.abs(one - start) - Math.abs(other - start))[0];
  return free || near === undefined ? Math.round(start / step) * step : near;
}

function letGo() {
  batch(() => {
    carried.value = null;
    barred.value = {};
  });
}

/** @param {Carried} now */
async function put(now) {
  if (now.start === now.from.start && now.operators.join() === now.from.operators.join()) return;
  await drop(now.task, now.operators, now.start);
}

/** @param {KeyboardEvent} event @param {Assignment} one @param {string} lane */
function onKey(event, one, lane) {
  const now = carried.value;
  const arrow = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
  if (event.ctrlKey || event.metaKey) return;
  if (arrow && !proposal.value) {
    if (!now?.keyed) begin(one, 0, 0, true);
    const held = /** @type {Carried} */ (carried.value);
    const step = grid() * (event.shiftKey ? 10 : 1);
    const rows = lanes();
    const row = rows.indexOf(held.operators.length > 1 ? lane : held.operators[0]) + arrow[1];
    const operators = one.operators.length > 1 || !rows[row] ? held.operators : [rows[row]];
    carryTo(operators, held.start + arrow[0] * step);
  } else if (now?.keyed && event.key === "Enter") {
    letGo();
    put(now);
  } else if (now?.keyed && event.key === "Escape") {
    letGo();
    say("status.cancelled");
  } else if (event.key === "l" || event.key === "L") toggleLock(one.task);
  else return;
  event.preventDefault();
  event.stopPropagation();
}

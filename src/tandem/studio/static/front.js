/**
 * The front: a list of the compromises to choose from, and the same points drawn in the plane of
 * makespan and stress. Found, bounded and proven points differ in shape and in words.
 * @module
 */
import { isOutside, recommended } from "./recommended.js";
import { choose, front, hand, pointName, proposal, running, selected } from "./state.js";
import { shown, t } from "./words.js";
import { html, observed } from "./view.js";

/** @typedef {import("./state.js").Point} Point */

const WIDTH = 300;
const HEIGHT = 190;
const EDGE = { left: 52, right: 16, top: 14, bottom: 40 };

/** @param {Point} point @returns {"proven" | "bound" | "found"} what is known about it. */
export function standing(point) {
  if (point.status === "optimal") return "proven";
  const { makespan, stress } = point.bound ?? {};
  return makespan != null || stress != null ? "bound" : "found";
}

/** @param {Point} point @returns {string} its standing in words, with the bound where there is one. */
function standingWords(point) {
  const kind = standing(point);
  if (kind !== "bound") return t(`front.${kind}`);
  const { makespan, stress } = point.bound;
  return t("front.bound", { makespan: makespan ?? "?", stress: stress ?? "?" });
}

export const Front = observed(() => {
  const points = front.value;
  if (points.length === 0) return html`<p class="empty">${t(running.value ? "front.searching" : "front.empty")}</p>`;
  return html`
    <div class="front" role="listbox" aria-label=${t("front.title")} onKeyDown=${onKey}>
      ${points.map(
        (point, index) => html`
          <div
            key=${index}
            role="option"
            class="point ${isOutside(index) ? "outside" : ""}"
            aria-selected=${index === selected.value}
            aria-description=${standingWords(point) + (index === recommended.value ? `, ${t("front.recommended")}` : "") + (isOutside(index) ? `, ${t("front.outside")}` : "")}
            tabindex=${index === selected.value ? 0 : -1}
            data-index=${index}
            onClick=${() => choose(index)}
          >
            <svg class="mark" viewBox="-8 -8 16 16" aria-hidden="true"><${Mark} kind=${standing(point)} /></svg>
            <span class="numbers">${pointName(point)}</span>
            <span class="standing" aria-hidden="true">
              ${standingWords(point)}${isOutside(index) ? ` · ${t("front.outside")}` : ""}${index === recommended.value ? html` · <b>${t("front.recommended")}</b>` : null}
            </span>
          </div>
        `,
      )}
    </div>
    <div class="drawn-front">
      <${Chart} points=${points} chosen=${hand.value || proposal.value ? -1 : selected.value} />
      <${Key} />
    </div>
  `;
});

/** @param {KeyboardEvent} event */
function onKey(event) {
  const last = front.value.length - 1;
  const to = { ArrowDown: selected.value + 1, ArrowUp: selected.value - 1, Home: 0, End: last }[event.key];
  if (event.key === "Enter" || event.key === " ") choose(selected.value);
  else if (to === undefined || to < 0 || to > last) return;
  else {
    choose(to);
    const list = /** @type {HTMLElement} */ (event.currentTarget);
    requestAnimationFrame(() => /** @type {HTMLElement | null} */ (list.querySelector(`[data-index="${to}"]`))?.focus());
  }
  event.preventDefault();
}

/** A proven point is full, a bounded one ringed, a found one hollow. @param {{kind: string}} props */
function Mark({ kind }) {
  if (kind === "proven") return html`<circle r="6" class="dot proven" />`;
  if (kind === "bound") return html`<g><circle r="6" class="dot" /><circle r="2.4" class="dot proven" /></g>`;
  return html`<rect x="-5" y="-5" width="10" height="10" class="dot" transform="rotate(45)" />`;
}

const Key = observed(() =>
  html`<p class="key">
    ${["proven", "bound", "found"].map(
      (kind) => html`<span><svg class="mark" viewBox="-8 -8 16 16" aria-hidden="true"><${Mark} kind=${kind} /></svg> ${t(`key.${kind}`)}</span>`,
    )}
  </p>`,
);

/** @param {number[]} values @returns {[number, number]} a little more than what they span. */
function span(values) {
  const low = Math.min(...values);
  const high = Math.max(...values);
  const room = (high - low || high || 1) * 0.12;
  return [Math.max(0, low - room), high + room];
}

/** @param {number} low @param {number} high @param {number} most @returns {number[]} round numbers between. */
export function ticks(low, high, most) {
  const rough = (high - low) / most || 1;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((factor) => factor * power).find((one) => one >= rough) ?? rough;
  const first = Math.ceil(low / step - 1e-9);
  const count = Math.floor(high / step + 1e-9) - first + 1;
  return Array.from({ length: Math.max(count, 0) }, (_, i) => Math.round((first + i) * step * 1e6) / 1e6);
}

/** The points in the plane; the list above says the same in words. */
const Chart = observed((/** @type {{points: Point[], chosen: number}} */ { points, chosen }) => {
  const [left, right] = span(points.map((p) => p.makespan));
  const [low, high] = span(points.map((p) => p.stress));
  /** @param {number} value */
  const x = (value) => EDGE.left + ((value - left) / (right - left)) * (WIDTH - EDGE.left - EDGE.right);
  /** @param {number} value */
  const y = (value) => HEIGHT - EDGE.bottom - ((value - low) / (high - low)) * (HEIGHT - EDGE.top - EDGE.bottom);
  const line = points.map((p, i) => (i ? `H${x(p.makespan)}V${y(p.stress)}` : `M${x(p.makespan)},${y(p.stress)}`)).join("");
  return html`
    <svg class="plane" viewBox="0 0 ${WIDTH} ${HEIGHT}" aria-hidden="true">
      ${ticks(left, right, 4).map(
        (value) => html`<g><line class="grid" x1=${x(value)} x2=${x(value)} y1=${EDGE.top} y2=${HEIGHT - EDGE.bottom} />
          <text x=${x(value)} y=${HEIGHT - EDGE.bottom + 16} text-anchor="middle">${shown(value)}</text></g>`,
      )}
      ${ticks(low, high, 4).map(
        (value) => html`<g><line class="grid" x1=${EDGE.left} x2=${WIDTH - EDGE.right} y1=${y(value)} y2=${y(value)} />
          <text x=${EDGE.left - 6} y=${y(value) + 5} text-anchor="end">${shown(value)}</text></g>`,
      )}
      <text x=${(WIDTH + EDGE.left) / 2} y=${HEIGHT - 6} text-anchor="middle">${t("front.makespan")}</text>
      <text transform="translate(14 ${(HEIGHT - EDGE.bottom) / 2}) rotate(-90)" text-anchor="middle">${t("front.stress")}</text>
      <path class="stairs" d=${line} />
      ${points.map(
        (p, i) => html`<g class="reach" transform="translate(${x(p.makespan)} ${y(p.stress)})" onClick=${() => choose(i)}>
          <circle r="13" class=${i === chosen ? "chosen" : "target"} /><${Mark} kind=${standing(p)} /></g>`,
      )}
    </svg>
  `;
});

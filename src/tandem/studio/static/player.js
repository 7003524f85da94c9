/**
 * Plays the schedule on show: a slider for the time, a speed, and what everybody does at that moment.
 * @module
 */
import { looksOf } from "./looks.js";
import { moment } from "./gantt.js";
import { cell, point } from "./state.js";
import { t } from "./words.js";
import { html, observed, signal, useEffect } from "./view.js";

const SPEEDS = [1, 2, 5, 10];

const playing = signal(false);
const speed = signal(SPEEDS[1]);

export const Player = observed(() => {
  const now = point.value;
  const end = now?.makespan ?? 0;
  const runs = playing.value;
  const rate = speed.value;
  useEffect(() => {
    if (!runs) return;
    let before = performance.now();
    let frame = requestAnimationFrame(function next(time) {
      const to = (moment.value ?? 0) + ((time - before) / 1000) * rate;
      before = time;
      moment.value = Math.min(to, end);
      if (to >= end) playing.value = false;
      else frame = requestAnimationFrame(next);
    });
    return () => cancelAnimationFrame(frame);
  }, [runs, rate, end]);
  if (!now) return null;
  const at = Math.min(moment.value ?? 0, end);
  return html`
    <div class="player">
      <button onClick=${() => toggle(end)}>${t(runs ? "player.pause" : "player.play")}</button>
      <label>${t("player.time")}
        <input type="range" min="0" max=${end} step="0.1" value=${at} aria-valuetext=${t("seconds", { n: Math.round(at * 10) / 10 })}
          onInput=${(/** @type {any} */ event) => (moment.value = Number(event.currentTarget.value))} />
      </label>
      <span class="at">${t("seconds", { n: Math.floor(at * 10) / 10 })}</span>
      <button onClick=${() => (speed.value = SPEEDS[(SPEEDS.indexOf(rate) + 1) % SPEEDS.length])}>${t("player.speed", { n: rate })}</button>
      ${moment.value === null ? null : html`<${Doing} at=${at} />`}
    </div>
  `;
});

/** @param {number} end */
function toggle(end) {
  if (!playing.value && (moment.value ?? end) >= end) moment.value = 0;
  playing.value = !playing.value;
}

/** What each operator does at a moment. */
const Doing = observed((/** @type {{at: number}} */ { at }) => {
  const looks = looksOf(cell.value);
  return html`<p class="doing">
    ${cell.value.operators.map((operator) => {
      const one = point.value?.assignments.find((a) => a.operators.includes(operator.name) && a.start <= at && at < a.end);
      return html`<span><span class="swatch ${looks.get(operator.name)?.class}" aria-hidden="true"></span> ${looks.get(operator.name)?.label}: <b>${one ? t("task", { task: one.task }) : t("player.idle")}</b></span>`;
    })}
  </p>`;
});

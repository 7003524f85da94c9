/**
 * The page: its bar of buttons, the line of status, and where each view stands.
 * @module
 */
import * as api from "./api.js";
import { Explain } from "./explain.js";
import { Front } from "./front.js";
import { Gantt } from "./gantt.js";
import { Graph } from "./graph.js";
import { Player } from "./player.js";
import {
  canRedo, canUndo, cell, conflict, dirty, faults, file, infeasible, makePlan, open, options, plan, redo, running, save, saveAnyway, say, selected, status, stopPlan, takeTheirs, undo, watchForFaults, work,
} from "./state.js";
import { Table } from "./table.js";
import { LANGUAGES, language, loadWords, speak, t } from "./words.js";
import { effect, html, observed, render, signal } from "./view.js";

const KEPT_THEME = "tandem.theme";
const THEMES = /** @type {const} */ (["auto", "light", "dark"]);
const theme = signal(localStorage.getItem(KEPT_THEME) ?? "auto");
effect(() => {
  document.documentElement.dataset.theme = theme.value;
});

const App = observed(() => {
  if (!work.value) return html`<main class="loading"><${Status} /></main>`;
  return html`
    <${Bar} />
    <${Status} />
    <${Newer} />
    <main>
      <section class="side" aria-label=${t("front.title")}>
        <h2>${t("front.title")}</h2>
        <${Front} />
        <${Why} />
      </section>
      <section class="plan" aria-label=${t("gantt.title")}>
        <${Gantt} />
        <${Player} />
        <div class="explain"><${Explain} /></div>
      </section>
      <section class="tasks" aria-label=${t("table.title")}><${Table} /></section>
      <section class="precedence" aria-label=${t("graph.title")}><${Graph} /></section>
    </main>
  `;
});

const Bar = observed(() => html`
  <header>
    <h1>${String(cell.value.name ?? file.value.name)}<span class="faint">${file.value.name}${dirty.value ? ` · ${t("file.unsaved")}` : ""}</span></h1>
    <div class="buttons">
      ${running.value
        ? html`<button class="first" onClick=${stopPlan}>${t("button.stop")}</button>`
        : html`<button class="first" onClick=${makePlan} title=${t("keys.plan")} disabled=${faults.value.length > 0}>${t("button.plan")}</button>`}
      <label class="inline">${t("options.limit")}
        <input type="number" min="1" max="3600" value=${options.value.time_limit} onChange=${setLimit} />
      </label>
      <button onClick=${undo} disabled=${!canUndo.value} title=${t("keys.undo")}>${t("button.undo")}</button>
      <button onClick=${redo} disabled=${!canRedo.value} title=${t("keys.redo")}>${t("button.redo")}</button>
      <button onClick=${save} disabled=${!dirty.value} title=${t("keys.save")}>${t("button.save")}</button>
      <${Share} />
      <select class="quiet" aria-label=${t("language")} onChange=${(/** @type {any} */ event) => speak(event.currentTarget.value)}>
        ${LANGUAGES.map((name) => html`<option value=${name} lang=${name} selected=${name === language.value}>${t(`language.${name}`)}</option>`)}
      </select>
      <select class="quiet" aria-label=${t("theme")} onChange=${setTheme}>
        ${THEMES.map((name) => html`<option value=${name} selected=${name === theme.value}>${t(`theme.${name}`)}</option>`)}
      </select>
    </div>
  </header>
`);

/** @param {any} event */
function setLimit(event) {
  const seconds = Math.min(3600, Math.max(1, Number(event.currentTarget.value) || 10));
  options.value = { ...options.value, time_limit: seconds };
  event.currentTarget.value = String(seconds);
}

/** @param {any} event */
function setTheme(event) {
  theme.value = event.currentTarget.value;
  localStorage.setItem(KEPT_THEME, theme.value);
}

const Status = observed(() => {
  const lost = !api.connected.value;
  const { key, values, tone } = lost ? { key: "status.lost", values: {}, tone: "bad" } : status.value;
  return html`<p class="status ${tone ?? ""}"><span role="status">${t(key, values)}</span>${running.value ? html`<progress aria-hidden="true"></progress>` : null}</p>`;
});

const Newer = observed(() =>
  conflict.value
    ? html`<div class="newer"><span>${t("newer.sentence", { name: file.value.name })}</span>
        <button onClick=${takeTheirs}>${t("newer.take")}</button><button onClick=${saveAnyway}>${t("newer.over")}</button></div>`
    : null,
);

/** The report of what was planned, as one file. */
const Share = observed(() => {
  if (!plan.value?.document.cell_document || running.value) return null;
  return html`<button onClick=${download} title=${t("keys.report")}>${t("button.report")}</button>`;
});

async function download() {
  const answer = await api.report({ plan: plan.value?.document, point: selected.value + 1, form: "html" });
  if (!answer.ok) return say("status.refused", { reason: (await answer.json()).error }, "bad");
  const name = /filename="?([^";]+)/.exec(answer.headers.get("Content-Disposition") ?? "")?.[1] ?? "plan.html";
  const link = document.createElement("a");
  link.href = URL.createObjectURL(await answer.blob());
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
  say("status.downloaded", { name });
}

/** Why there is no plan. */
const Why = observed(() => {
  const why = infeasible.value;
  if (!why) return null;
  return html`<div class="faults"><b>${t("infeasible.title")}</b><pre>${JSON.stringify(why, null, 1)}</pre></div>`;
});

/** @param {KeyboardEvent} event */
function onKey(event) {
  if (!(event.ctrlKey || event.metaKey) || event.altKey) return;
  // A field that is being typed into has an undo of its own.
  const typing = event.target instanceof HTMLInputElement && event.target.type === "text";
  const key = event.key.toLowerCase();
  if (key === "s") save();
  else if (key === "enter") makePlan();
  else if (typing) return;
  else if (key === "z") event.shiftKey ? redo() : undo();
  else if (key === "y") redo();
  else return;
  event.preventDefault();
}

addEventListener("keydown", onKey);
addEventListener("beforeunload", (event) => dirty.value && event.preventDefault());
await loadWords();
const root = /** @type {HTMLElement} */ (document.getElementById("studio"));
render(html`<${App} />`, root);
await open();
watchForFaults();

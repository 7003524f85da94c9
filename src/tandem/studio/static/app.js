/**
 * The page: its bar of buttons, the line of status, and where each view stands.
 * @module
 */
import * as api from "./api.js";
import { Balance, Changed } from "./balance.js";
import { Explain } from "./explain.js";
import { Front } from "./front.js";
import { Gantt } from "./gantt.js";
import { Graph, watchGraph } from "./graph.js";
import { Import, Preview } from "./importer.js";
import { watchMeasures } from "./measures.js";
import { Operators } from "./operators.js";
import { Player } from "./player.js";
import { at, Problems, Why } from "./problems.js";
import { Sliders } from "./recommended.js";
import { Resources } from "./resources.js";
import { Scenarios, watchScenarios } from "./scenarios.js";
import {
  canRedo, canUndo, cell, conflict, dirty, faults, file, files, forgetUnsaved, hand, listFiles, makePlan, open, options, plan, proposal, redo, running, save, saveAnyway, say, selected, setOption, status, stopPlan, takeTheirs, takeUnsaved, undo, unsaved, watchForFaults, work,
} from "./state.js";
import { Table } from "./table.js";
import { LANGUAGES, language, loadWords, speak, t } from "./words.js";
import { Field, Menu, effect, html, observed, render, signal } from "./view.js";

const KEPT_THEME = "tandem.theme";
const systemIsDark = matchMedia("(prefers-color-scheme: dark)");
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
    <${Unsaved} />
    <main>
      <${Preview} />
      <section class="side" aria-label=${t("front.title")}>
        <h2>${t("front.title")}</h2>
        <${Limits} />
        <${Front} />
        <${Sliders} />
        <${Why} />
      </section>
      <section class="plan" aria-label=${t("gantt.title")}>
        <${Gantt} />
        <${Changed} />
        <${Balance} />
        <${Player} />
        <${Explain} />
      </section>
      <div class="below">
      <section class="tasks" aria-label=${t("table.title")}><${Table} /><${Problems} /></section>
      <section class="precedence" aria-label=${t("graph.title")}><${Graph} /></section>
      <section class="resources" aria-label=${t("resources.title")}><${Resources} /></section>
      <section class="people" aria-label=${t("operators.title")}><${Operators} /></section>
      <section class="scenarios" aria-label=${t("scenarios.title")}><${Scenarios} /></section>
      </div>
    </main>
  `;
});

const Bar = observed(() => html`
  <header>
    <h1>${String(cell.value.name ?? file.value.name)}<span class="faint">${file.value.name}${dirty.value ? ` · ${t("file.unsaved")}` : ""}</span></h1>
    <${Others} />
    <div class="buttons">
      ${running.value
        ? html`<button class="first" onClick=${stopPlan}>${t("button.stop")}</button>`
        : html`<button class="first" onClick=${makePlan} title=${t("keys.plan")} disabled=${faults.value.length > 0}>${t("button.plan")}</button>`}
      <button onClick=${undo} disabled=${!canUndo.value} title=${t("keys.undo")}>${t("button.undo")}</button>
      <button onClick=${redo} disabled=${!canRedo.value} title=${t("keys.redo")}>${t("button.redo")}</button>
      <button onClick=${save} disabled=${!dirty.value} title=${t("keys.save")}>${t("button.save")}</button>
      <${Import} />
      <${Share} />
      ${LANGUAGES.filter((name) => name !== language.value).map(
        (name) => html`<button key=${name} class="quiet" lang=${name} onClick=${() => speak(name)}>${t(`language.${name}`)}</button>`,
      )}
      <button class="quiet" onClick=${changeTheme}>${t(isDark() ? "theme.light" : "theme.dark")}</button>
    </div>
  </header>
`);

/** The other cells of the folder. */
const Others = observed(() => {
  const items = files.value.filter((name) => name !== file.value.name).map((name) => ({ key: name, label: name }));
  if (items.length === 0) return null;
  return html`<${Menu} label=${t("file.other")} items=${items} choose=${openOther} />`;
});

/** @param {string} name */
function openOther(name) {
  if (dirty.value) say("status.unsaved", {}, "bad");
  else open(name);
}

/** Whether the page is dark now: by choice, or as the system is. */
const isDark = () => theme.value === "dark" || (theme.value === "auto" && systemIsDark.matches);

function changeTheme() {
  theme.value = isDark() ? "light" : "dark";
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

const Unsaved = observed(() =>
  unsaved.value
    ? html`<div class="newer"><span>${t("unsaved.sentence", { name: file.value.name })}</span>
        <button onClick=${takeUnsaved}>${t("unsaved.take")}</button><button onClick=${forgetUnsaved}>${t("unsaved.forget")}</button></div>`
    : null,
);

const CHARTS = ["gantt", "front", "graph"];

/** What was planned as files: the report in one, each chart as a picture. */
const Share = observed(() => {
  if (running.value || !reported()) return null;
  const charts = CHARTS.map((key) => ({ key, label: t(`chart.${key}`) }));
  return html`<button onClick=${() => download({ form: "html" })} title=${t("keys.report")}>${t("button.report")}</button>
    <${Menu} label=${t("button.pictures")} items=${charts} choose=${(/** @type {string} */ chart) => download({ form: "svg", chart })} />`;
});

/** The document of the schedule on show, and which of its points it is; null where it was only placed by hand. */
function reported() {
  if (proposal.value) return null;
  if (hand.value) return hand.value.document ? { plan: hand.value.document, point: 1 } : null;
  return plan.value?.document.cell_document ? { plan: plan.value.document, point: selected.value + 1 } : null;
}

/** @param {{form: string, chart?: string}} what */
async function download(what) {
  const answer = await api.report({ ...reported(), ...what, lang: language.value });
  if (!answer.ok) return say("status.refused", { reason: (await answer.json()).error }, "bad");
  const name = /filename="?([^";]+)/.exec(answer.headers.get("Content-Disposition") ?? "")?.[1] ?? "plan.html";
  const link = document.createElement("a");
  link.href = URL.createObjectURL(await answer.blob());
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
  say("status.downloaded", { name });
}

/** What the planner is held to: its time, and limits on what it may find. */
const Limits = observed(() => {
  /** @param {string} name @param {number} least @param {number} most */
  const field = (name, least, most) => html`<label>${t(`options.${name}`)}
    <${Field} type="number" min=${least} max=${most} step="any" data-at=${at("question", name)} value=${String(options.value[name] ?? "")}
      commit=${(/** @type {string} */ given) =>
        setOption(name, given === "" ? (name === "time_limit" ? 10 : undefined) : Math.min(most, Math.max(least, Number(given))))} /></label>`;
  return html`<div class="limits">${field("max_makespan", 0, 1e9)}${field("max_stress", 0, 1e9)}${field("time_limit", 1, 3600)}</div>`;
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
// Nothing is drawn before both are there: until then the first page shows its outlines.
const [, opened] = await Promise.allSettled([loadWords(), open()]);
render(html`<${App} />`, /** @type {HTMLElement} */ (document.getElementById("studio")));
if (opened.status === "rejected") throw opened.reason;
await listFiles();
watchGraph();
watchForFaults();
watchMeasures();
watchScenarios();
